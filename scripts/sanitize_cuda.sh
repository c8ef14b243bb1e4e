#!/usr/bin/env bash
# Small runs of the command on the device under compute-sanitizer: memory, races in shared memory, reads of memory that
# nothing wrote, barriers. One line a tool and run; exit status 1 when one complains. Works in a bundle too.
#   sanitize_cuda.sh [-o LOG_FOLDER] [-t "TOOLS"] [COMMAND]   COMMAND is vdb_isomesh beside this file or in build/cuda
set -uo pipefail
root=$(cd "$(dirname "$0")" && pwd)
[ -x "$root/vdb_isomesh" ] || root=$(dirname "$root")
logs=
tools="memcheck initcheck racecheck synccheck"
while getopts o:t: option; do
  case $option in
    o) logs=$OPTARG ;;
    t) tools=$OPTARG ;;
    *) sed -n 4p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
command=${1:-$root/vdb_isomesh}
[ -x "$command" ] || command=$root/build/cuda/vdb_isomesh
command -v compute-sanitizer >/dev/null || PATH=$PATH:/usr/local/cuda/bin
command -v compute-sanitizer >/dev/null || { echo "skipped: no compute-sanitizer"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ -n "$logs" ] || logs=$work
mkdir -p "$logs"

# A box of twelve triangles; an open one, whose gap is closed; and a scan on a coarse grid.
printf 'OFF\n8 12 0\n0 0 0\n3 0 0\n0 2 0\n3 2 0\n0 0 1\n3 0 1\n0 2 1\n3 2 1\n' > "$work/box.off"
faces='3 0 6 4\n3 0 2 6\n3 1 7 3\n3 1 5 7\n3 0 5 1\n3 0 4 5\n3 2 7 6\n3 2 3 7\n3 0 3 2\n3 0 1 3\n'
{ cat "$work/box.off"; printf "$faces"; printf '3 4 7 5\n3 4 6 7\n'; } > "$work/closed.off"
{ sed 's/^8 12 0/8 10 0/' "$work/box.off"; printf "$faces"; } > "$work/open.off"
scan=$root/tests/data/nefertiti.ply

failed=0
sanitize() { # tool, name, arguments of the command...
  local tool=$1 name=$2 log=$logs/$1_$2.log start=$SECONDS status words
  shift 2
  compute-sanitizer --tool "$tool" --error-exitcode 9 "$command" "$@" --device cuda --force -q > "$log" 2>&1
  status=$?
  words=$(grep -E 'ERROR SUMMARY|RACECHECK SUMMARY' "$log" | tail -n 1 | sed 's/^=* *//')
  printf '%-10s %-12s exit %d  %4d s  %s\n' "$tool" "$name" "$status" $((SECONDS - start)) "$words"
  [ "$status" -eq 0 ] || failed=1
}

for tool in $tools; do
  sanitize $tool box "$work/closed.off" "$work/out.off" --vertices 60 --resolution 24
  sanitize $tool open "$work/open.off" "$work/out.off" --vertices 60 --resolution 24 --close-gaps 6vox
  sanitize $tool scan "$scan" "$work/out.off" --vertices 300 --resolution 48
  sanitize $tool shell "$scan" "$work/out.off" --vertices 200 --resolution 40 --method shell --iterations 10 \
    --save-voronoi "$work/out.vdb"
done
exit $failed
