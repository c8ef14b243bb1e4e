#!/usr/bin/env bash
# From a fresh clone to a mesh: sets up, builds, and remeshes a real scan. Results go to demo-output/.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh cpu vdb_isomesh
out=demo-output
mkdir -p "$out"
build/cpu/vdb_isomesh tests/data/nefertiti.ply "$out/nefertiti.ply" --vertices 10000 --force \
  --save-voronoi "$out/nefertiti.voronoi.vdb" --stats "$out/nefertiti.json" --require closed,manifold
echo
echo "The scan tests/data/nefertiti.ply was remeshed. Look at:"
echo "  $PWD/$out/nefertiti.ply   the mesh"
echo "  $PWD/$out/nefertiti.voronoi.vdb   shell and Voronoi cells, for OpenVDB viewers; a run can resume from it"
echo "  $PWD/$out/nefertiti.json   everything that was measured"
