#!/usr/bin/env bash
# Makes build/python, where the Python module is built and tested: a virtual environment with packages from PyPI. Where
# they cannot be had, the module and its tests are left out. Pages of --report are tried in a browser where chromium is
# (apt install chromium: 400 MB).
#   scripts/python_env.sh [tests|ci]     with `ci` all that any test wants, and without PyPI it fails
set -euo pipefail
cd "$(dirname "$0")/.."
packages=(numpy nanobind pytest mypy trimesh k3d usd-core distributed fsspec psutil dask-jobqueue)
if command -v chromium >/dev/null; then packages+=(playwright); fi
if [ "${1:-}" = ci ]; then packages+=(pyvista); fi
modules=("${packages[@]/usd-core/pxr}")
modules=("${modules[@]//-/_}")
python=build/python/bin/python

if ! "$python" -c "import ${modules[*]/%/,} sys" 2>/dev/null; then
  echo "setup: installing ${packages[*]} from PyPI into build/python" >&2
  python3 -m venv build/python
  if ! "$python" -m pip install --quiet --disable-pip-version-check "${packages[@]}"; then
    echo "setup: PyPI cannot be reached, so the Python module and its tests are left out" >&2
    echo "the Python module and its tests (PyPI cannot be reached)" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"
    rm -rf build/python
    [ "${1:-}" != ci ] || exit 1
  fi
fi
