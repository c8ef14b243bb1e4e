#!/usr/bin/env bash
# Tests the packed extension of Blender as a user would have it: installs build/blender/isoshell-VERSION.zip into an
# empty folder of Blender's, and runs blender/tests there. Needs Python 3.11 and, for Blender as a module (bpy), PyPI;
# BPY_VERSION names another version of it, which is installed if build/bpy is not there yet.
#   scripts/test_blender.sh [PYTHON3.11] [ARGUMENTS OF pytest...]
set -euo pipefail
cd "$(dirname "$0")/.."
python=build/bpy/bin/python
if ! "$python" -c "import bpy, pytest" 2>/dev/null; then
  echo "installing bpy from PyPI into build/bpy" >&2
  "${1:-python3.11}" -m venv build/bpy
  build/bpy/bin/pip install --quiet --disable-pip-version-check "bpy==${BPY_VERSION:-5.0.1}" "numpy<2" pytest
fi
[ $# -gt 0 ] && shift
version=$(sed -n 's/^project(isoshell VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
package=$PWD/build/blender/isoshell-$version.zip
[ -e "$package" ] || scripts/blender_extension.sh
resources=$(mktemp -d)
trap 'rm -rf "$resources"' EXIT
BLENDER_USER_RESOURCES=$resources ISOSHELL_EXTENSION=$package PYTHONDONTWRITEBYTECODE=1 \
  "$python" -m pytest -q -p no:cacheprovider blender/tests "$@"
