#!/usr/bin/env bash
# Whole-process seconds of vdb_isomesh beside CGAL's isotropic_remeshing at the same vertex count, alternating.
# usage: peer_cgal.sh VDB_ISOMESH PEER MESH.off VERTICES EDGE_LENGTH [RUNS=3]
#   PEER IN OUT EDGE_LENGTH remeshes with CGAL; EDGE_LENGTH = 1.07 * sqrt(area / VERTICES) gives it about that count.
set -euo pipefail
command=$1 peer=$2 mesh=$3 vertices=$4 edge=$5 runs=${6:-3}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
measure() { # name, command...
  local name=$1
  shift
  /usr/bin/time -f "$name cpu_s %U+%S wall_s %e peak_kb %M" "$@" >/dev/null 2>"$folder/log" || { cat "$folder/log" >&2; exit 1; }
  tail -n 1 "$folder/log"
}
for _ in $(seq "$runs"); do
  measure isoshell "$command" "$mesh" "$folder/ours.off" --vertices "$vertices" --force -q
  measure cgal "$peer" "$mesh" "$folder/peer.off" "$edge"
done
