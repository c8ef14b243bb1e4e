#!/usr/bin/env bash
# Makes build/python, where the Python module is built and tested: a virtual environment with packages from PyPI. Where
# they cannot be had, the module and its tests are left out, or, with an environment of before, tests alone. Pages of --report are tried in a browser where chromium is
# (apt install chromium: 400 MB).
#   scripts/python_env.sh [tests|ci]
# With `ci` it has all that any test wants, and clang-format; there is build/python-torch beside it, whose torch is that of
# the system's package, for the processor alone; and where one of all these cannot be had, it fails.
set -euo pipefail
cd "$(dirname "$0")/.."

left_out() { # text
  echo "setup: PyPI cannot be reached, so left out are $1" >&2
  echo "$1 (PyPI cannot be reached)" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"
}

# Makes an environment unless it is there and can import these modules.
environment() { # folder, modules, command that makes it, packages...
  local folder=$1 modules=$2 make=$3
  shift 3
  ! "$folder/bin/python" -c "import $modules" 2>/dev/null || return 0
  echo "setup: installing $* from PyPI into $folder" >&2
  $make "$folder" && "$folder/bin/python" -m pip install --quiet --disable-pip-version-check "$@"
}

packages=(numpy scipy nanobind pytest mypy trimesh lxml networkx meshio h5py nibabel k3d usd-core distributed fsspec psutil dask-jobqueue cryptography manifold3d==3.5.4)
if command -v chromium google-chrome >/dev/null; then packages+=(playwright); fi
if [ "${1:-}" = ci ]; then packages+=(pyvista gmsh tetgen pymeshlab pyarrow); fi
modules=${packages[*]%%==*}
modules=${modules/usd-core/pxr}
modules=${modules//-/_}
ours=(build/python "${modules// /,}" "python3 -m venv" "${packages[@]}")
if [ "${1:-}" = ci ]; then
  environment build/python-torch torch,pytest "/usr/bin/python3 -m venv --system-site-packages" pytest
  ours[1]+=,clang_format
  environment "${ours[@]}" clang-format==14.0.6
elif [ -e build/python ]; then
  environment "${ours[@]}" || left_out "tests that need what build/python lacks"
elif ! environment "${ours[@]}"; then
  rm -rf build/python
  left_out "the Python module and its tests"
fi
