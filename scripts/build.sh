#!/usr/bin/env bash
# Configures and builds one preset (cpu unless named) into build/<preset>. Further arguments are targets.
# ISOSHELL_STRICT=ON in the environment makes errors of warnings in any preset.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-cpu}
[ $# -gt 0 ] && shift
launcher=()
if command -v ccache >/dev/null; then
  . scripts/ccache.sh
  launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_CUDA_COMPILER_LAUNCHER=ccache)
fi
strict=()
[ -z "${ISOSHELL_STRICT:-}" ] || strict=("-DISOSHELL_STRICT=$ISOSHELL_STRICT")
python=()  # the Python module, where setup.sh has made what it needs
case "$preset" in
  cpu | cuda | cpu-asan)
    if [ -x build/python/bin/python ]; then
      python=(-DISOSHELL_PYTHON=ON "-DPython_EXECUTABLE=$PWD/build/python/bin/python")
    fi
    if [ -x build/python-torch/bin/python ]; then
      python+=("-DISOSHELL_TORCH_PYTHON=$PWD/build/python-torch/bin/python")
    fi
    ;;
esac
cmake --preset "$preset" "${launcher[@]}" "${strict[@]}" "${python[@]}" >&2
targets=()
[ $# -gt 0 ] && targets=(--target "$@")
cmake --build --preset "$preset" "${targets[@]}" >&2
