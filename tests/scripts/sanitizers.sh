#!/bin/sh
# Every unit test under clang's address, undefined-behaviour and unsigned-overflow sanitizers.
exec make --no-print-directory -C "$(dirname "$0")/../.." B="$SPANTEX_BUILD" sanitize
