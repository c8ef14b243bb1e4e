#!/usr/bin/env bash
# Whole-process seconds of vdb_isomesh beside CGAL's isotropic_remeshing, alternating, and CPU microseconds for each
# vertex made: the peer makes more or fewer than it is asked for.
# usage: peer_cgal.sh VDB_ISOMESH PEER MESH.off VERTICES EDGE_LENGTH [RUNS=3]
#   PEER IN OUT EDGE_LENGTH remeshes with CGAL, compiled with -O3 -DNDEBUG; without NDEBUG it takes half as long again.
#   EDGE_LENGTH = 1.07 * sqrt(area / VERTICES) gives it about that count.
set -euo pipefail
command=$1 peer=$2 mesh=$3 vertices=$4 edge=$5 runs=${6:-3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
measure() { # name, OFF file that is written, command...
  local name=$1 out=$2
  shift 2
  /usr/bin/time -f "%U %S %e %M" "$@" >/dev/null 2>"$folder/log" || { cat "$folder/log" >&2; exit 1; }
  tail -n 1 "$folder/log" | awk -v name="$name" -v made="$(sed -n 2p "$out" | cut -d' ' -f1)" '{
    printf "%s vertices %d cpu_s %.2f wall_s %.2f peak_kb %d cpu_us_a_vertex %.1f\n", name, made, $1 + $2, $3, $4, ($1 + $2) * 1e6 / made }'
}
for _ in $(seq "$runs"); do
  measure isoshell "$folder/ours.off" "$command" "$mesh" "$folder/ours.off" --vertices "$vertices" --device cpu --force -q
  measure cgal "$folder/peer.off" "$peer" "$mesh" "$folder/peer.off" "$edge"
done
