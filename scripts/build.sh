#!/usr/bin/env bash
# Configures and builds one preset (cpu unless named) into build/<preset>. Further arguments are targets.
# ISOSHELL_STRICT=ON in the environment makes errors of warnings in any preset, ISOSHELL_CUDA_FOR_ALL=ON compiles for every
# device that is supported, not for those of this machine alone. Without they are off again (CMakePresets.json).
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-cpu}
[ $# -gt 0 ] && shift
. scripts/ccache.sh
python=()  # the Python module, where setup.sh has made what it needs
case "$preset" in
  cpu | cuda | cpu-asan)
    if build/python/bin/python -c 'import nanobind, pytest' 2>/dev/null; then
      python=(-DISOSHELL_PYTHON=ON "-DPython_EXECUTABLE=$PWD/build/python/bin/python")
    fi
    if [ -x build/python-torch/bin/python ]; then
      python+=("-DISOSHELL_TORCH_PYTHON=$PWD/build/python-torch/bin/python")
    fi
    ;;
esac
cmake --preset "$preset" "${python[@]}" >&2
targets=()
[ $# -gt 0 ] && targets=(--target "$@")
cmake --build --preset "$preset" "${targets[@]}" >&2
