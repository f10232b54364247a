#!/bin/sh
# Each deliberate break of the code is noticed by the test named for it.
exec "$(dirname "$0")/../gates.py"
