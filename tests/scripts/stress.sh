#!/bin/sh
# The short form of `make stress`: 10^7 coordinates in exact and default, 2 10^6 in the others.
set -eu
spantex="${SPANTEX_BUILD:-build}/spantex"
for p in exact default; do "$spantex" stress --profile $p --evaluations 10000000 --threads 2; done
for p in seed compact; do "$spantex" stress --profile $p --evaluations 2000000 --threads 2; done
