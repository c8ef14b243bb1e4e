#!/usr/bin/env bash
# Installs the Debian packages into a clean system of each named suite, builds the project of tests/install against them
# there and runs it, checks them with lintian, and executes the RUN lines of packaging/docker. For a maintainer before a
# release: needs root, debootstrap, 4 GB of disk and some minutes a suite.
#   scripts/test_packages.sh [SUITE...]        default: bookworm trixie (Debian 12 and 13)
# Packages depend on their suite's OpenVDB and TBB. Those of this system's suite are built here, in build/packages, others
# and with BUILD_INSIDE=1 all from HEAD in a clean system of that suite, by the stage build of the Dockerfile.
# The mirror is this system's own; MIRROR names another. KEEP=1 leaves the packages in build/packages-SUITE, and
# CMAKE_BUILD_PARALLEL_LEVEL says how many compilers run at once. http_proxy and PIP_CERT, the certificates of a network
# that has its own, hold inside, too.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$(id -u)" -eq 0 ] || { echo "packages: needs root, for chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "packages: needs debootstrap (apt-get install debootstrap)" >&2; exit 1; }
# A mount namespace of its own: whatever is mounted below ends with this script, however it ends.
[ -n "${ISOSHELL_IN_NAMESPACE:-}" ] || ISOSHELL_IN_NAMESPACE=1 exec unshare --mount --pid --fork "$0" "$@"

mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1)}
[ -n "$mirror" ] || { echo "packages: apt names no mirror; set MIRROR" >&2; exit 1; }
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-}
work=$(mktemp -d)
trap 'umount -q "$work"/*/*/proc "$work"/*/*/dev/pts 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT

inside() { # root, command...
  local root=$1
  shift
  mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
  mountpoint -q "$root/dev/pts" || mount -t devpts -o newinstance,ptmxmode=666 devpts "$root/dev/pts"  # terminals of zsh
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    ${http_proxy:+http_proxy="$http_proxy"} ${PIP_CERT:+PIP_CERT=/pip_cert.pem} ${jobs:+CMAKE_BUILD_PARALLEL_LEVEL="$jobs"} chroot "$root" "$@"
}

quietly() { # command...: its output only when it fails
  "$@" >"$work/log" 2>&1 || { tail -n 30 "$work/log" >&2; return 1; }
}

install_packages() { # root, package...
  local root=$1
  shift
  quietly inside "$root" apt-get -qq install -y --no-install-recommends "$@"
}

# Executes the RUN lines of a stage of a Dockerfile, as a container engine would.
run_stage() { # root, Dockerfile, stage
  local line lines
  lines=$(awk -v stage="$3" '/^FROM/ { here = $NF == stage } here && sub(/^RUN /, "")' "packaging/docker/$2.Dockerfile")
  [ -n "$lines" ] || { echo "packages: $2.Dockerfile has no RUN lines in a stage $3" >&2; return 1; }
  while read -r line; do
    quietly inside "$1" bash -c "cd /isoshell && $line" </dev/null
  done <<<"$lines"
}

build_here() { # folder of the packages
  quietly scripts/packages.sh
  cp build/packages/*.deb "$1"
}

build_inside() { # root
  run_stage "$1" cpu build
  cp "$1"/isoshell/build/packages/*.deb "$1/packages"
}

check_packages() { # root: lintian knows the suite's policy
  install_packages "$1" lintian
  inside "$1" sh -c 'lintian --fail-on error --tag-display-limit 0 --allow-root /packages/*.deb'
}

# Man page and completions as they are installed.
check_command_docs() { # root, command
  inside "$1" sh -c "mkdir /docs_$2 && cd /docs_$2 && cp /usr/share/bash-completion/completions/$2 $2.bash &&
    cp /usr/share/zsh/vendor-completions/_$2 /usr/share/fish/vendor_completions.d/$2.fish . &&
    zcat /usr/share/man/man1/$2.1.gz > $2.1 && /isoshell/tests/cli/test_command_docs.sh $2 ."
}

use_packages() { # root
  local root=$1 packages=("$1"/packages/libisoshell-dev_*.deb)
  run_stage "$root" cpu run
  quietly inside "$root" apt-get update  # the stage leaves no lists behind
  quietly inside "$root" python3 -m isoshell /isoshell/tests/data/nefertiti.ply /python.ply --vertices 4000 -q
  # A name with a slash is a file to apt, which takes from the mirror what it depends on.
  install_packages "$root" "${packages[@]#"$root"}" g++ cmake make pkg-config man-db bash-completion zsh fish mandoc groff-base
  quietly inside "$root" cmake -S /isoshell/tests/install -B /user
  quietly inside "$root" cmake --build /user
  inside "$root" /user/remesh /isoshell/tests/data/nefertiti.ply /out
  quietly inside "$root" sh -c 'g++ -std=c++17 /isoshell/examples/01_remesh.cpp -o /by_pkg_config $(pkg-config --cflags --libs isoshell)'
  inside "$root" /by_pkg_config /isoshell/tests/data/nefertiti.ply /by_pkg_config_out
  inside "$root" vdb_isomesh /isoshell/tests/data/nefertiti.ply /command.ply --vertices 4000 -q --require closed,manifold
  inside "$root" cmp /command.ply /python.ply
  inside "$root" vdb_meshinfo /command.ply --ref /isoshell/tests/data/nefertiti.ply -q --require closed,manifold
  inside "$root" vdb_isomesh --version
  check_command_docs "$root" vdb_isomesh
  check_command_docs "$root" vdb_meshinfo
  check_command_docs "$root" isoshell
  inside "$root" isoshell info /command.ply -q --require closed,manifold
  inside "$root" cmp /command.ply /out.ply
  inside "$root" cmp /command.ply /by_pkg_config_out.ply
  inside "$root" dpkg-query -W '*isoshell*' 'libopenvdb*'
  quietly inside "$root" apt-get -qq purge -y isoshell python3-isoshell libisoshell-dev
  local left
  left=$(find "$root/usr" "$root/etc" "$root/var" -xdev -name '*isoshell*' -o -name '*vdb_isomesh*' -o -name '*vdb_meshinfo*')
  [ -z "$left" ] || { echo "packages: left after purge: $left" >&2; return 1; }
  run_stage "$root" cuda run
  inside "$root" vdb_isomesh --version
}

[ $# -gt 0 ] || set -- bookworm trixie
for suite in "$@"; do
  echo "== $suite"
  start=$SECONDS
  mkdir -p "$work/$suite"
  quietly debootstrap --variant=minbase "$suite" "$work/$suite/user" "$mirror"
  mkdir "$work/$suite/user/isoshell" "$work/$suite/user/packages"
  [ -z "${PIP_CERT:-}" ] || cp "$PIP_CERT" "$work/$suite/user/pip_cert.pem"
  git archive HEAD | tar -x -C "$work/$suite/user/isoshell"
  if [ -z "${BUILD_INSIDE:-}" ] && [ "$suite" = "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" ]; then
    build_here "$work/$suite/user/packages"
  else
    cp -a "$work/$suite/user" "$work/$suite/build"
    build_inside "$work/$suite/build"
    cp "$work/$suite"/build/packages/*.deb "$work/$suite/user/packages"
  fi
  if [ -n "${KEEP:-}" ]; then
    mkdir -p "build/packages-$suite"
    cp "$work/$suite"/user/packages/*.deb "build/packages-$suite"
  fi
  cp -a "$work/$suite/user" "$work/$suite/lintian"
  check_packages "$work/$suite/lintian"
  use_packages "$work/$suite/user"
  umount "$work/$suite"/*/proc "$work/$suite"/*/dev/pts
  rm -rf --one-file-system "${work:?}/$suite"
  echo "== $suite: installed, built and ran in $((SECONDS - start)) s"
done
