#!/usr/bin/env bash
# Installs a build into a folder of its own and builds and runs the first example against it, as found by CMake and, where
# pkg-config is, by that after the folder was moved.
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
[ ! -e "$folder/user/grid_user" ] || "$folder/user/grid_user" "$folder/ball.ply"
[ ! -e "$folder/isoshell/bin/vdb_isomesh" ] || "$folder/isoshell/bin/vdb_isomesh" --version
# A project that was written for another minor version is told so when it is configured.
if cmake -S "$source/tests/install" -B "$folder/older" "$@" -Disoshell_ROOT="$folder/isoshell" -DISOSHELL_WANTED=0.0 \
    >/dev/null 2>&1; then
  echo "version 0.0 was asked for, and this one was taken" >&2
  exit 1
fi
# The compiler and its options are among those of CMake.
by_pkg_config() {
  local option compiler=c++ compile=() found
  for option; do
    case "$option" in
      -DCMAKE_CXX_COMPILER=*) compiler=${option#*=} ;;
      -DCMAKE_CXX_FLAGS=*) read -r -a compile <<<"${option#*=}" ;;
    esac
  done
  mv "$folder/isoshell" "$folder/moved"
  found=$(PKG_CONFIG_PATH=$(dirname "$(find "$folder/moved" -name isoshell.pc)") pkg-config --cflags --libs isoshell)
  # shellcheck disable=SC2086
  "$compiler" -std=c++17 "${compile[@]}" "$source/examples/01_remesh.cpp" -o "$folder/by_pkg_config" $found
  "$folder/by_pkg_config" "$source/tests/data/nefertiti.ply" "$folder/out_by_pkg_config"
  cmp "$folder/out.ply" "$folder/out_by_pkg_config.ply"
  [ -e "$folder/user/grid_user" ] || return 0
  found=$(PKG_CONFIG_PATH=$(dirname "$(find "$folder/moved" -name isoshell.pc)") pkg-config --cflags --libs isoshell-openvdb)
  # shellcheck disable=SC2086
  "$compiler" -std=c++17 "${compile[@]}" "$source/tests/install/grid_user.cpp" -o "$folder/grid_by_pkg_config" $found
  "$folder/grid_by_pkg_config" "$folder/ball_by_pkg_config.ply"
  cmp "$folder/ball.ply" "$folder/ball_by_pkg_config.ply"
}
if command -v pkg-config >/dev/null; then
  by_pkg_config "$@"
else
  echo "install as pkg-config finds it (not installed)" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"
fi
find "$folder" -name LICENSE | grep -q .
