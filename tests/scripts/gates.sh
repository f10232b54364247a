#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Deliberate breaks of the code are noticed by the tests named for them: one for each suite. `make check-gates` tries all.
exec "$(dirname "$0")/../gates.py" --short
