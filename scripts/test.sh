#!/usr/bin/env bash
# Sets up, builds and runs all tests, and says at its end what had to be left out. An argument names another preset:
# cpu-asan, cpu-tsan, strict.
#   scripts/test.sh [--complete] [PRESET]     with --complete nothing may be left out: the run fails where a tool is missing
set -euo pipefail
cd "$(dirname "$0")/.."
tools=tests
if [ "${1:-}" = --complete ]; then tools=ci; shift; fi
preset=${1:-cpu}

# Setup and tests write a line to this file for what they leave out.
export ISOSHELL_LEFT_OUT=$PWD/build/left_out.txt
mkdir -p build
: >"$ISOSHELL_LEFT_OUT"
scripts/setup.sh "$tools"
scripts/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)"
if [ -s "$ISOSHELL_LEFT_OUT" ]; then
  echo "left out: $(sort -u "$ISOSHELL_LEFT_OUT" | paste -sd ';' | sed 's/;/; /g')" >&2
  [ "$tools" != ci ] || exit 1
fi
