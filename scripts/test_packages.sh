#!/usr/bin/env bash
# Installs the Debian packages into a clean system of each named suite, builds the project of tests/install against them
# there and runs it. For a maintainer before a release: needs root, debootstrap, 4 GB of disk and some minutes a suite.
#   scripts/test_packages.sh [SUITE...]        default: bookworm trixie (Debian 12 and 13)
# Packages depend on their suite's OpenVDB and TBB. Those of this system's suite are built here, in build/cpu, others
# from HEAD in a system of that suite.
# The mirror is this system's own; MIRROR names another. KEEP=1 leaves the packages in build/packages-SUITE.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$(id -u)" -eq 0 ] || { echo "packages: needs root, for chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "packages: needs debootstrap (apt-get install debootstrap)" >&2; exit 1; }
# A mount namespace of its own: whatever is mounted below ends with this script, however it ends.
[ -n "${ISOSHELL_IN_NAMESPACE:-}" ] || ISOSHELL_IN_NAMESPACE=1 exec unshare --mount --pid --fork "$0" "$@"

mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1)}
[ -n "$mirror" ] || { echo "packages: apt names no mirror; set MIRROR" >&2; exit 1; }
work=$(mktemp -d)
trap 'umount -q "$work"/*/*/proc 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT

inside() { # root, command...
  local root=$1
  shift
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    ${http_proxy:+http_proxy="$http_proxy"} chroot "$root" "$@"
}

quietly() { # command...: its output only when it fails
  "$@" >"$work/log" 2>&1 || { tail -n 30 "$work/log" >&2; return 1; }
}

install_packages() { # root, package...
  local root=$1
  shift
  quietly inside "$root" apt-get -qq install -y --no-install-recommends "$@"
}

build_here() { # folder of the packages
  quietly scripts/build.sh cpu
  quietly cpack --config build/cpu/CPackConfig.cmake -B "$1"
}

build_inside() { # root
  quietly inside "$1" bash -c 'cd /isoshell && scripts/setup.sh'
  install_packages "$1" dpkg-dev file
  quietly inside "$1" bash -c 'cd /isoshell && cmake --preset cpu -DISOSHELL_TESTS=OFF -DISOSHELL_BENCH=OFF &&
    cmake --build --preset cpu && cpack --config build/cpu/CPackConfig.cmake -B /packages'
}

use_packages() { # root
  local packages=("$1"/packages/*.deb)
  # A name with a slash is a file to apt, which takes from the mirror what it depends on.
  install_packages "$1" "${packages[@]#"$1"}" g++ cmake make
  quietly inside "$1" cmake -S /isoshell/tests/install -B /user
  quietly inside "$1" cmake --build /user
  inside "$1" /user/remesh /isoshell/tests/data/nefertiti.ply /out
  inside "$1" vdb_isomesh /isoshell/tests/data/nefertiti.ply /command.ply --vertices 4000 -q --require closed,manifold
  inside "$1" vdb_isomesh --version
  inside "$1" sha256sum /out.ply /command.ply
  inside "$1" dpkg-query -W '*isoshell*' 'libopenvdb*'
}

[ $# -gt 0 ] || set -- bookworm trixie
for suite in "$@"; do
  echo "== $suite"
  start=$SECONDS
  mkdir -p "$work/$suite"
  quietly debootstrap --variant=minbase "$suite" "$work/$suite/user" "$mirror"
  mkdir "$work/$suite/user/isoshell" "$work/$suite/user/packages"
  git archive HEAD | tar -x -C "$work/$suite/user/isoshell"
  if [ "$suite" = "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" ]; then
    build_here "$work/$suite/made"
    cp "$work/$suite"/made/*.deb "$work/$suite/user/packages"
  else
    cp -a "$work/$suite/user" "$work/$suite/build"
    build_inside "$work/$suite/build"
    cp "$work/$suite"/build/packages/*.deb "$work/$suite/user/packages"
  fi
  if [ -n "${KEEP:-}" ]; then
    mkdir -p "build/packages-$suite"
    cp "$work/$suite"/user/packages/*.deb "build/packages-$suite"
  fi
  use_packages "$work/$suite/user"
  umount "$work/$suite"/*/proc
  rm -rf --one-file-system "${work:?}/$suite"
  echo "== $suite: installed, built and ran in $((SECONDS - start)) s"
done
