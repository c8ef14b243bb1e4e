#!/usr/bin/env bash
# Builds the Debian packages of this system's suite into build/packages: the command, the library, the Python module for
# the system's own Python. Needs what `scripts/setup.sh packages` installs.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=build/packages python=build/python-system
[ -x $python/bin/python ] || /usr/bin/python3 -m venv $python
# nanobind is no package of Debian 12; numpy runs the command whose man page is made.
$python/bin/python -c 'import nanobind, numpy' 2>/dev/null ||
  $python/bin/python -m pip install --quiet --disable-pip-version-check nanobind numpy typing_extensions
. scripts/ccache.sh
cmake -S . -B $folder -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DISOSHELL_CUDA="${ISOSHELL_CUDA:-off}" \
  -DISOSHELL_CUDA_FOR_ALL=ON \
  -DISOSHELL_TESTS=OFF -DISOSHELL_BENCH=OFF -DISOSHELL_PYTHON=ON -DISOSHELL_PYTHON_DIR=lib/python3/dist-packages \
  -DPython_EXECUTABLE="$PWD/$python/bin/python" -DPython3_EXECUTABLE=/usr/bin/python3 >&2
cmake --build $folder "$@" >&2
rm -f $folder/*.deb
(cd $folder && cpack) >&2
ls $folder/*.deb
