#!/usr/bin/env bash
# Makes a folder, and a packed copy of it, that runs on a machine without compilers and libraries: the commands, the tests
# with what they read, the benches, and the shared libraries that they need. A GPU machine needs its driver, nothing more.
#   scripts/bundle.sh [--no-build] [--without-tests] [PRESET [FOLDER]]
# PRESET is cuda unless named; FOLDER is build/PRESET/isoshell-bundle. --no-build takes what is built already.
set -euo pipefail
cd "$(dirname "$0")/.."

build=1 with_tests=1
while [[ ${1:-} == --* ]]; do
  case $1 in
    --no-build) build=0 ;;
    --without-tests) with_tests=0 ;;
    *) echo "bundle: unknown option $1" >&2; exit 2 ;;
  esac
  shift
done
preset=${1:-cuda}
from=$PWD/build/$preset
folder=${2:-$from/isoshell-bundle}
[ "$build" -eq 0 ] || ISOSHELL_CUDA_FOR_ALL=ON scripts/build.sh "$preset"
for command in vdb_isomesh vdb_meshinfo; do
  [ -x "$from/$command" ] || { echo "bundle: $from/$command is not built" >&2; exit 1; }
done
limit_mb=60

rm -rf "$folder" "$folder.tar.xz"
mkdir -p "$folder/lib" "$folder/tests" "$folder/bench"
script=$(mktemp)
trap 'rm -f "$script"' EXIT

# Executable, folder. Without symbols, and without the colon that CMake leaves at the end of a path: it would mean the
# folder that the user happens to be in.
copy() {
  local to=$2/${1##*/}
  cp "$1" "$to"
  strip --strip-unneeded "$to"
  echo "file(RPATH_SET FILE \"$to\" NEW_RPATH \"\$ORIGIN/lib:\$ORIGIN/../lib\")" > "$script"
  cmake -P "$script"
}

for command in vdb_isomesh vdb_meshinfo; do copy "$from/$command" "$folder"; done
if [ "$with_tests" -eq 1 ]; then
  while read -r name executable arguments; do
    path=$(find "$from/tests" -name "$executable" -type f -perm -u+x)
    [ -n "$path" ] || { echo "bundle: left out $name, it is not built" >&2; continue; }
    [ -e "$folder/tests/$executable" ] || copy "$path" "$folder/tests"
    echo "$name $executable $arguments" >> "$folder/tests/list.txt"
  done < "$from/tests/list.txt"
  [ ! -x "$from/tests/parity_meshes" ] || copy "$from/tests/parity_meshes" "$folder/tests"
  cp scripts/run_tests.sh scripts/sanitize_cuda.sh "$folder"
  mkdir -p "$folder/tests/golden" "$folder/tests/fuzz" "$folder/scripts" "$folder/examples" "$folder/docs/guide"
  cp tests/golden/golden.txt "$folder/tests/golden"
  cp -r tests/data "$folder/tests"
  cp -r tests/fuzz/corpus "$folder/tests/fuzz"
  cp README.md "$folder"  # more files that tests of the command read
  cp docs/guide/command.md "$folder/docs/guide"
  cp examples/01_remesh.cpp "$folder/examples"
  cp scripts/option_table.sh scripts/command_{completions,docs,help}.py "$folder/scripts"
fi
find "$from/bench" -maxdepth 1 -name 'bench_*' -type f -perm -u+x | while read -r bench; do copy "$bench" "$folder/bench"; done
cp LICENSE "$folder"

# Everything but the C library, which is the target's own (as new as this machine's, or newer), and the driver.
needed=$(find "$folder"/vdb_* "$folder/tests" "$folder/bench" -maxdepth 1 -type f -perm -u+x -exec ldd {} +)
missing=$(grep 'not found' <<<"$needed" | sort -u || true)
[ -z "$missing" ] || { echo "bundle: not found: $missing" >&2; exit 1; }
sed -nE 's/.* => (\/[^ ]+) .*/\1/p' <<<"$needed" | sort -u |
  grep -vE '/(ld-linux[^/]*|lib(c|m|dl|rt|pthread|resolv|util|mvec)|libcuda|libnvidia[^/]*)\.so[^/]*$' |
  while read -r library; do
    cp -L "$library" "$folder/lib"
    strip --strip-unneeded "$folder/lib/${library##*/}"
  done
{
  echo "isoshell $(git describe --always --dirty 2>/dev/null || echo '(no git)'), preset $preset"
  ldd --version | sed -n '1s/^ldd/built against/p'  # all of it read: a pipe that closes early fails the script
} > "$folder/VERSION"

# The tests share most of their machine code, so a window as large as the folder packs it once.
tar -C "$(dirname "$folder")" -cf - "$(basename "$folder")" | xz -T2 --lzma2=preset=3,dict=512MiB > "$folder.tar.xz"
bytes=$(stat -c %s "$folder.tar.xz")
echo "bundle: $folder ($(du -sm "$folder" | cut -f1) MB), packed $folder.tar.xz ($((bytes / 1000000)) MB)"
[ "$bytes" -le $((limit_mb * 1000000)) ] || { echo "bundle: over $limit_mb MB packed" >&2; exit 1; }
