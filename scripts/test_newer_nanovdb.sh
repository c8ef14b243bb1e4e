#!/usr/bin/env bash
# Builds and runs the NanoVDB test against a newer NanoVDB than the installed one (32.6 or later, OpenVDB 11 to 13).
# Takes the headers from a Debian suite with an apt state of its own, so that the system's sources stay as they are.
#   scripts/test_newer_nanovdb.sh [suite]        (default: forky)
# An existing header tree can be used instead: NANOVDB_INCLUDE=/path/that/holds/nanovdb scripts/test_newer_nanovdb.sh
# ISOSHELL_CUDA=on builds the CUDA backend against it too, for this machine's device, and tests that.
set -euo pipefail
cd "$(dirname "$0")/.."
suite=${1:-forky}
deps=$PWD/.deps
include=${NANOVDB_INCLUDE:-$deps/nanovdb-$suite/usr/include}

if [ ! -d "$include/nanovdb" ]; then
  state=$deps/apt-$suite
  mkdir -p "$state/lists/partial" "$state/cache/archives/partial"
  # The mirror that this system uses; MIRROR names another.
  mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | head -n 1)}
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $suite main" > "$state/sources.list"
  options=(-o Dir::Etc::sourcelist="$state/sources.list" -o Dir::Etc::sourceparts=/dev/null
           -o Dir::State::lists="$state/lists" -o Dir::Cache="$state/cache" -o APT::Sandbox::User=root)
  apt-get "${options[@]}" -qq update
  (cd "$state" && apt-get "${options[@]}" -qq download libnanovdb-dev)
  dpkg -x "$state"/libnanovdb-dev_*.deb "$deps/nanovdb-$suite"
  rm -rf "$state"
fi

cuda=${ISOSHELL_CUDA:-off}
cmake -S . -B build-newer-nanovdb -DISOSHELL_VDB=OFF -DISOSHELL_TOOLS=OFF -DISOSHELL_BENCH=OFF -DISOSHELL_CUDA="$cuda" \
  -DCMAKE_CUDA_ARCHITECTURES=native -DNanoVDB_INCLUDE_DIR="$include"
cmake --build build-newer-nanovdb --target test_nano -j "$(nproc)"
build-newer-nanovdb/tests/test_nano --success | grep -m1 "NanoVDB 32" || true
build-newer-nanovdb/tests/test_nano
[ "$cuda" != on ] || build-newer-nanovdb/tests/test_nano --cuda
