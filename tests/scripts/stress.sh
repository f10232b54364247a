#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The short form of `make stress`: 10^7 coordinates in every profile.
set -eu
spantex="${SPANTEX_BUILD:-build}/spantex"
for p in exact default compact seed; do "$spantex" stress --profile $p --evaluations 10000000 --threads 2; done
