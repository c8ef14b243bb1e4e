#!/usr/bin/env bash
# Sets up, builds and runs all tests, and says at its end what was left out for want of a tool. An argument names another
# preset: cpu-asan, cpu-tsan, strict.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-cpu}

# Setup and tests write a line to this file for what they leave out.
export ISOSHELL_LEFT_OUT=${ISOSHELL_LEFT_OUT:-$PWD/build/left_out.txt}
mkdir -p build
: >"$ISOSHELL_LEFT_OUT"
scripts/setup.sh tests
scripts/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)"
if [ -s "$ISOSHELL_LEFT_OUT" ]; then
  echo "left out: $(sort -u "$ISOSHELL_LEFT_OUT" | paste -sd ';' | sed 's/;/; /g')" >&2
fi
