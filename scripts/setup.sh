#!/usr/bin/env bash
# Installs what the build needs and this machine lacks. Debian 12 and 13, Ubuntu 24.04 and newer.
# Nothing is downloaded when everything is there. ccache, clang-format and clang are only used when present.
# `setup.sh tests` adds what only tests run: OpenVDB's own tools and Python module, which open the files that we write,
# and the environment of our own Python module; and, where they can be had, shells and readers of man pages for the tests
# of completions and pages, which leave out what is not there. `setup.sh packages` adds what scripts/packages.sh needs.
set -euo pipefail

packages=(build-essential cmake ninja-build libopenvdb-dev libnanovdb-dev libtbb-dev libblosc-dev zlib1g-dev
          libboost-iostreams-dev libimath-dev libcli11-dev nlohmann-json3-dev catch2 python3-minimal)
wished=()
case "${1:-}" in
  "") ;;
  tests)
    packages+=(libopenvdb-tools python3-openvdb python3-dev python3-venv)
    wished=(fish groff-base mandoc man-db pkg-config zsh)
    ;;
  packages) packages+=(python3-dev python3-venv dpkg-dev file) ;;
  *) echo "setup: unknown argument: $1 (tests, packages)" >&2; exit 2 ;;
esac

# CUDA is not installed from here: which toolkit fits is the driver's and the administrator's to say.
if ! command -v nvcc >/dev/null && [ ! -x /usr/local/cuda/bin/nvcc ]; then
  echo "setup: no nvcc, so only the CPU backend can be built. The CUDA backend takes a toolkit from 12.0 to 13.x" >&2
  echo "       (https://developer.nvidia.com/cuda-downloads; package nvidia-cuda-toolkit on Ubuntu 24.04 and Debian 13)," >&2
  echo "       the preset cuda, and to run a device of compute capability 7.5 or newer with its driver." >&2
fi

if ! command -v dpkg-query >/dev/null; then
  echo "setup: this is not a Debian or Ubuntu system; install by hand what these packages hold: ${packages[*]}" >&2
  exit 1
fi

install_missing() { # package...
  local package missing=() as_root=()
  for package; do
    [ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null)" = "install ok installed" ] || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup: need root or sudo to install: ${missing[*]}" >&2; return 1; }
    as_root=(sudo)
  fi
  echo "setup: installing ${missing[*]}" >&2
  "${as_root[@]}" apt-get update &&
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

install_missing "${packages[@]}"
if install_missing "${wished[@]}"; then
  echo "setup: everything is installed" >&2
else
  echo "setup: the tests leave out what needs one of these: ${wished[*]}" >&2
fi
if [ "${1:-}" = tests ]; then "$(dirname "$0")/python_env.sh"; fi
