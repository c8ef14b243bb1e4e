#!/usr/bin/env bash
# Makes build/python, where the Python module is built and tested: a virtual environment with packages from PyPI. Where
# they cannot be had, the module and its tests are left out. Pages of --report are tried in a browser where chromium is
# (apt install chromium: 400 MB).
set -euo pipefail
cd "$(dirname "$0")/.."
packages=(numpy nanobind pytest mypy trimesh k3d usd-core distributed fsspec psutil dask-jobqueue)
if command -v chromium >/dev/null; then packages+=(playwright); fi
modules=("${packages[@]/usd-core/pxr}")
modules=("${modules[@]//-/_}")
python=build/python/bin/python

if ! "$python" -c "import ${modules[*]/%/,} sys" 2>/dev/null; then
  echo "setup: installing ${packages[*]} from PyPI into build/python" >&2
  python3 -m venv build/python
  if ! "$python" -m pip install --quiet --disable-pip-version-check "${packages[@]}"; then
    echo "setup: PyPI cannot be reached, so the Python module and its tests are left out" >&2
    rm -rf build/python
  fi
fi
