#!/usr/bin/env bash
# Installs a build into a folder of its own and builds and runs the
# first example against it.
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
find "$folder/isoshell" -name LICENSE | grep -q .
