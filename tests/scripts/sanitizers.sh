#!/bin/sh
# The whole suite under clang's address, undefined-behaviour and unsigned-overflow sanitizers: tests/sanitized.py tells what that is.
exec make --no-print-directory -C "$(dirname "$0")/../.." B="$SPANTEX_BUILD" sanitize
