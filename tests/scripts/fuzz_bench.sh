#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The fuzz targets of the bench on their committed corpus and a few thousand inputs; `make fuzz` runs 10^7 each.
exec make --no-print-directory -C "$(dirname "$0")/../.." B="$SPANTEX_BUILD" FUZZ_RUNS=5000 fuzz
