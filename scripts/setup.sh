#!/usr/bin/env bash
# Installs what the build needs and this machine lacks. Debian 12 and 13, Ubuntu 24.04 and newer.
# Nothing is downloaded when everything is there. ccache, clang-format and clang are only used when present.
#   scripts/setup.sh [tests|ci|packages]
# `tests` adds what only tests run: OpenVDB's own tools and Python module, which open the files that we write, a fast
# linker, and the environment of our own Python module; and, where they can be had, shells and readers of man pages for
# the tests of completions and pages, which leave out what is not there. `ci` adds what no part of .ci/run may go
# without, a browser and torch among them, and fails where one of all these cannot be had. `packages` adds what
# scripts/packages.sh needs.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(build-essential cmake ninja-build libopenvdb-dev libnanovdb-dev libtbb-dev libblosc-dev zlib1g-dev
          libboost-iostreams-dev libimath-dev libdraco-dev libmeshoptimizer-dev libcli11-dev nlohmann-json3-dev catch2
          python3-minimal)
of_tests=(libopenvdb-tools python3-openvdb python3-dev python3-venv mold)
wished=(fish groff-base mandoc man-db pkg-config zsh)
case "${1:-}" in
  "") wished=() ;;
  tests) packages+=("${of_tests[@]}") ;;
  ci)
    packages+=("${of_tests[@]}" "${wished[@]}" ccache clang-tidy git python3-torch
               libglu1-mesa libxcursor1 libxft2 libxinerama1)  # the last four are for gmsh of PyPI
    command -v google-chrome >/dev/null || packages+=(chromium)
    wished=()
    ;;
  packages) packages+=(python3-dev python3-venv dpkg-dev file) wished=() ;;
  *) echo "setup: unknown argument: $1 (tests, ci, packages)" >&2; exit 2 ;;
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

# Another apt may be at work, as in the first minutes of a new machine: its lock is waited for.
apt_get() { "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -o DPkg::Lock::Timeout=300 "$@"; }

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
  apt_get update -qq || return
  # Asked for the sizes only, apt says no to itself.
  apt_get install --no-install-recommends --assume-no "${missing[@]}" 2>/dev/null |
    sed -nE 's/^(Need to get|After this operation)/setup:   \1/p; s/^([0-9]+ upgraded, )/setup:   \1/p' >&2 || true
  apt_get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

install_missing "${packages[@]}"
if ! install_missing "${wished[@]}"; then
  echo "tests of what needs one of these: ${wished[*]}" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"
fi
echo "setup: everything that is needed is installed" >&2
case "${1:-}" in tests | ci) scripts/python_env.sh "$1" ;; esac
