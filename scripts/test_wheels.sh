#!/usr/bin/env bash
# Installs the wheels of scripts/wheel.sh into clean systems that have their own Python and none of our packages, and
# remeshes there, to the bytes of the command, which is VDB_ISOMESH or that of the preset cpu. For a maintainer before a
# release: needs root, debootstrap, PyPI and a minute a suite.
#   scripts/test_wheels.sh [SUITE...]        default: bookworm trixie (Debian 12 and 13)
# The mirror is this system's own; MIRROR names another.
set -euo pipefail
cd "$(dirname "$0")/.."
[ "$(id -u)" -eq 0 ] || { echo "wheels: needs root, for chroot" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "wheels: needs debootstrap (apt-get install debootstrap)" >&2; exit 1; }
# A mount namespace of its own: whatever is mounted below ends with this script, however it ends.
[ -n "${ISOSHELL_IN_NAMESPACE:-}" ] || ISOSHELL_IN_NAMESPACE=1 exec unshare --mount --pid --fork "$0" "$@"

command=${VDB_ISOMESH:-build/cpu/vdb_isomesh}
[ -x "$command" ] || { echo "wheels: needs the command (scripts/build.sh cpu vdb_isomesh)" >&2; exit 1; }
mirror=${MIRROR:-$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' | grep -v security | head -n 1)}
suites=("$@")
[ ${#suites[@]} -eq 0 ] && suites=(bookworm trixie)
work=$(mktemp -d)
trap 'umount -q "$work"/*/proc 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT

inside() { # root, command...
  local root=$1
  shift
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 chroot "$root" "$@"
}

for suite in "${suites[@]}"; do
  root=$work/$suite
  debootstrap --variant=minbase --include=python3,python3-venv "$suite" "$root" "$mirror" >"$work/log" 2>&1 ||
    { tail -n 30 "$work/log" >&2; exit 1; }
  mount -t proc proc "$root/proc"
  version=$(inside "$root" python3 -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  mkdir "$root/wheels"
  cp build/dist/*.whl "$root/wheels"
  # Packages of that Python are fetched here: the clean system reaches no index.
  build/wheel-tools/bin/pip download --quiet --disable-pip-version-check --only-binary=:all: --python-version "$version" \
    --dest "$root/wheels" numpy
  inside "$root" python3 -m venv /empty
  inside "$root" /empty/bin/pip install --quiet --no-index --find-links /wheels isoshell
  echo "$suite:"
  inside "$root" /empty/bin/python -c "import isoshell"  # files are compiled and read now
  inside "$root" sh -c 'cd /tmp && /empty/bin/python -' < python/tests/try_wheel.py
  "$command" "$root/tmp/box.obj" "$work/command.ply" --vertices 300 -q --force
  cmp "$work/command.ply" "$root/tmp/out.ply"
done
