#!/usr/bin/env bash
# Installs a build into a folder of its own and builds and runs the first example against it.
#   test_install.sh BUILD [options of CMake]
set -euo pipefail
build=$1
shift
source=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cmake --install "$build" --prefix "$folder/isoshell" >/dev/null
# Found there, and nowhere in the tree that was built.
cmake -S "$source/tests/install" -B "$folder/user" "$@" -Disoshell_ROOT="$folder/isoshell"
cmake --build "$folder/user"
"$folder/user/remesh" "$source/tests/data/nefertiti.ply" "$folder/out"
[ -s "$folder/out.ply" ]
[ ! -e "$folder/isoshell/bin/vdb_isomesh" ] || "$folder/isoshell/bin/vdb_isomesh" --version
# A project that was written for another minor version is told so when it is configured.
if cmake -S "$source/tests/install" -B "$folder/older" "$@" -Disoshell_ROOT="$folder/isoshell" -DISOSHELL_WANTED=0.0 \
    >/dev/null 2>&1; then
  echo "version 0.0 was asked for, and this one was taken" >&2
  exit 1
fi
find "$folder/isoshell" -name LICENSE | grep -q .
