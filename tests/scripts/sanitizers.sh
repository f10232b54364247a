#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The short form of `make sanitize`: of the unit tests the suites of parsers, stores and raw addresses; all else in full. tests/sanitized.py tells what that is.
exec make --no-print-directory -C "$(dirname "$0")/../.." B="$SPANTEX_BUILD" \
  SUITES="bench_faults bc draw etc fixed formats global_memory kernels kernels_linear_light loader masks pack polygon recording texture visibility wide world" sanitize
