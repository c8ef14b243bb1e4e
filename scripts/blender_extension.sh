#!/usr/bin/env bash
# Packs the extension of Blender, with the wheels of scripts/wheel.sh inside, which are built first where build/dist lacks
# them:
#   build/blender/isoshell-VERSION.zip               for Blender 4.2 to 5.0, which are Python 3.11
#   build/blender/isoshell-VERSION-blender-5.1.zip   for Blender 5.1 and later
# One package cannot hold both wheels: the first Blenders with extensions take the last one, whatever its Python is. Each
# is packed where its Python is at hand (3.11; 3.12 or 3.13), and what is left out is said.
#   scripts/blender_extension.sh [PYTHON...]          packs for these; without any, for those of these versions on the path
#   ISOSHELL_CUDA=on scripts/blender_extension.sh     the same with the CUDA backend, isoshell-VERSION-cuda...zip
set -euo pipefail
cd "$(dirname "$0")/.."
version=$(sed -n 's/^project(isoshell VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
kind='' dist=build/dist
if [ "${ISOSHELL_CUDA:-off}" = on ]; then kind=-cuda dist=build/dist-cuda; fi
pythons=("$@") all=0
[ ${#pythons[@]} -gt 0 ] || all=1 pythons=(python3.11 python3.12 python3.13 python3)

# The first of the pythons that is one of these versions.
python_of() { # version...
  local python version
  for python in "${pythons[@]}"; do
    for version; do
      if "$python" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$version')" 2>/dev/null; then
        echo "$python"
        return
      fi
    done
  done
}
wheel_of() { ls -t "$dist/isoshell-$version-$1"-*.whl 2>/dev/null | head -n 1; }

pack() { # package, wheel, fields of the manifest in place of blender_version_min
  python3 - "$@" <<'PYTHON'
import sys
import zipfile
from pathlib import Path

package, wheel, versions = sys.argv[1:]
blender, wheel = Path("blender"), Path(wheel)
files = {path.name: path.read_bytes() for path in [*blender.glob("*.py"), Path("LICENSE"), Path("blender/README.md")]}
lines = (blender / "blender_manifest.toml").read_text().splitlines()
fields = [*versions.split(","), f'wheels = ["./wheels/{wheel.name}"]']
at = next(i for i, line in enumerate(lines) if line.startswith("blender_version_min"))
lines[at:at + 1] = fields
files["blender_manifest.toml"] = ("\n".join(lines[1:]) + "\n").encode()  # the first line is for who edits it
files[f"wheels/{wheel.name}"] = wheel.read_bytes()
with zipfile.ZipFile(package, "w") as archive:
    for name in sorted(files):  # of one date, so that the same files are the same bytes
        archive.writestr(zipfile.ZipInfo(name), files[name], zipfile.ZIP_DEFLATED)
PYTHON
}

mkdir -p build/blender
packed=0
package() { # tag of the wheel, end of the package's name, fields of the manifest, versions of Python...
  local tag=$1 name=build/blender/isoshell-$version$kind$2.zip fields=$3 python
  shift 3
  if [ -z "$(wheel_of "$tag")" ]; then
    python=$(python_of "$@")
    if [ -z "$python" ]; then
      [ "$all" -eq 1 ] || return 0
      echo "blender: left out $name: there is no Python ${*/%/ or}" | sed 's/ or$//' >&2
      echo "$name (no Python $*)" >>"${ISOSHELL_LEFT_OUT:-/dev/null}"
      return
    fi
    scripts/wheel.sh "$python"
  fi
  pack "$name" "$(wheel_of "$tag")" "$fields"
  packed=1
}
package cp311 '' 'blender_version_min = "4.2.0",blender_version_max = "5.1.0"' 3.11
package cp312-abi3 -blender-5.1 'blender_version_min = "5.1.0"' 3.12 3.13
[ "$packed" -eq 1 ] || { echo "blender: nothing packed: no wheel in $dist, and none of ${pythons[*]} is 3.11 to 3.13" >&2; exit 1; }
ls -l build/blender
