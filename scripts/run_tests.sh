#!/usr/bin/env bash
# Runs the tests of a bundle (scripts/bundle.sh) without CMake, prints one line a test, and fails when one fails.
#   run_tests.sh [-j JOBS] [-t SECONDS] [-o LOG_FOLDER] [NAME_PATTERN...]      patterns as in `case`; none means all
set -uo pipefail
root=$(cd "$(dirname "$0")" && pwd)
jobs=$(nproc) limit=600 logs=
while getopts j:t:o: option; do
  case $option in
    j) jobs=$OPTARG ;;
    t) limit=$OPTARG ;;
    o) logs=$OPTARG ;;
    *) sed -n 3p "$0" >&2; exit 2 ;;
  esac
done
shift $((OPTIND - 1))
[ -n "$logs" ] || logs=$(mktemp -d)
mkdir -p "$logs"
export ISOSHELL_SOURCE=$root VDB_ISOMESH=$root/vdb_isomesh VDB_MESHINFO=$root/vdb_meshinfo

chosen() { # name, pattern...
  local name=$1 pattern
  shift
  [ $# -eq 0 ] && return 0
  for pattern; do
    # shellcheck disable=SC2053
    [[ $name == $pattern ]] && return 0
  done
  return 1
}

run_one() { # name, executable, arguments...
  local name=$1 start=${EPOCHREALTIME/[.,]/} status word
  shift
  (cd "$root/tests" && timeout -k 5 "$limit" "./$@") > "$logs/$name.log" 2>&1 < /dev/null
  status=$?
  case $status in
    0) word=pass ;;
    77) word="skip  $(head -n 1 "$logs/$name.log")" ;;
    124 | 137) word="FAIL  longer than $limit s" ;;
    *) word="FAIL  exit status $status" ;;
  esac
  printf '%-24s %7.1f s  %s\n' "$name" "$(((${EPOCHREALTIME/[.,]/} - start) / 100000))e-1" "$word" | tee "$logs/$name.result"
}

rm -f "$logs"/*.result
while read -r -a test; do
  chosen "${test[0]}" "$@" || continue
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n; done
  run_one "${test[@]}" &
done < "$root/tests/list.txt"
wait

count() { grep -lE "  $1" "$logs"/*.result 2>/dev/null | wc -l; }
for result in $(grep -lE '  FAIL' "$logs"/*.result 2>/dev/null); do
  echo "== ${result##*/} (all of it: ${result%.result}.log)"
  tail -n 25 "${result%.result}.log"
done
echo "$(count pass) passed, $(count skip) skipped, $(count FAIL) failed; logs in $logs"
[ "$(count FAIL)" -eq 0 ] && [ "$(count pass)" -gt 0 ]
