#!/usr/bin/env bash
# Sets up, builds and runs all tests. An argument names another preset: cpu-asan, cpu-tsan, strict.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-cpu}
scripts/setup.sh tests
scripts/build.sh "$preset"
ctest --preset "$preset"
