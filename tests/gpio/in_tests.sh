#!/bin/sh
# The bench on a real kernel (`make test-gpio` with small pictures). Where packages may not be installed, it says so loudly and passes.
cd "$(dirname "$0")/../.."
if ! tools/setup gpio; then echo "SKIPPED: kernel and emulator cannot be installed here; the bench was not tried on a real kernel" >&2; exit 0; fi
exec make --no-print-directory B="$SPANTEX_BUILD" GPIO_SIZE=24x16 test-gpio
