#!/usr/bin/env bash
# Packs the extension of Blender, with the wheels of scripts/wheel.sh inside, which are built first where build/dist lacks
# them:
#   build/blender/isoshell-VERSION.zip               for Blender 4.2 to 5.0, which are Python 3.11
#   build/blender/isoshell-VERSION-blender-5.1.zip   for Blender 5.1 and later
# One package cannot hold both wheels: the first Blenders with extensions take the last one, whatever its Python is.
#   scripts/blender_extension.sh [PYTHON3.11 [PYTHON3.12]]
set -euo pipefail
cd "$(dirname "$0")/.."
pythons=("${1:-python3.11}" "${2:-python3.12}")
version=$(sed -n 's/^project(isoshell VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)

wheel_of() { ls -t build/dist/isoshell-"$version"-"$1"-*.whl 2>/dev/null | head -n 1; }
missing=()
[ -n "$(wheel_of cp311)" ] || missing+=("${pythons[0]}")
[ -n "$(wheel_of cp312-abi3)" ] || missing+=("${pythons[1]}")
[ ${#missing[@]} -eq 0 ] || scripts/wheel.sh "${missing[@]}"

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
pack "build/blender/isoshell-$version.zip" "$(wheel_of cp311)" \
  'blender_version_min = "4.2.0",blender_version_max = "5.1.0"'
pack "build/blender/isoshell-$version-blender-5.1.zip" "$(wheel_of cp312-abi3)" 'blender_version_min = "5.1.0"'
ls -l build/blender
