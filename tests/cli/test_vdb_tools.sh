#!/bin/sh
# Do OpenVDB's own tools and its Python module open what we write? Exit status 77: skipped, the tools are not installed.
# Usage: test_vdb_tools.sh WRITER COMMAND. The writer writes stage files and a preview into the folder that it is given.
set -eu
writer=$1
command=$(realpath "$2")
python="${PYTHON:-/usr/bin/python3} -s"  # a user's own NumPy may not fit the system's module
skip() {
  echo "skipped: $1"
  echo "vdb_tools ($1)" >> "${ISOSHELL_LEFT_OUT:-/dev/null}"
  exit 77
}
command -v vdb_print > /dev/null || skip "vdb_print is not installed"
$python -c 'import pyopenvdb' 2> /dev/null || skip "pyopenvdb is not installed"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$writer" "$folder"

expect() {  # FILE TEXT...: vdb_print -m lists every text
  file=$1
  shift
  vdb_print -m "$folder/$file" > "$folder/print.txt"
  for text in "$@"; do
    grep -q -- "$text" "$folder/print.txt" || { echo "vdb_print -m $file does not show: $text"; exit 1; }
  done
}
expect a.shell.vdb closest_site distance_sq_vox shell_distance closest_offset surface_points surface_triangles \
  'isoshell:stage: shell' 'class: unknown' 'vector_type: contravariant relative' 'creator: vdb_isomesh'
expect a.voronoi.vdb seed_id seed_points seed_normals seed_homes 'isoshell:stage: voronoi'
expect a.preview.vdb density seed_rand color 'class: fog volume'

$python - "$folder/a.preview.vdb" <<'PYTHON'
import sys, pyopenvdb
grids = {grid.name: grid for grid in pyopenvdb.readAll(sys.argv[1])[0]}
assert sorted(grids) == ["color", "density", "seed_rand"], sorted(grids)
counts = {name: grid.activeVoxelCount() for name, grid in grids.items()}
assert len(set(counts.values())) == 1 and counts["density"] > 0, counts
for value in grids["seed_rand"].citerOnValues():
    assert 0 < value.value <= 1, value.value

shell = sys.argv[1].replace("a.preview", "b.shell")
gap, band = (pyopenvdb.read(shell, name) for name in ("gap", "shell_distance"))
assert gap.activeVoxelCount() == band.activeVoxelCount() + 2
assert [v.min for v in gap.citerOnValues() if v.value == 1] == [(1000, 1000, 1000), (1001, 1000, 1000)]
try:
    pyopenvdb.read(shell.replace("b.shell", "a.shell"), "gap")
    raise AssertionError("a surface without gaps has a grid of them")
except KeyError:
    pass
PYTHON

command -v vdb_tool > /dev/null || skip "vdb_tool is not installed"
make_ball() { vdb_tool -quiet -sphere r=1 voxel=0.05 name=ball -sphere r=2 voxel=0.5 name=other "$@"; }
remesh() { "$command" "$@" --vertices 300 --quiet; }
make_ball -write "$folder/ball.vdb"
remesh "$folder/ball.vdb:ball" "$folder/file.ply"
vdb_tool -quiet -sphere r=1 voxel=0.05 -write stdout.vdb | remesh - "$folder/pipe.ply" --input-format vdb
cmp "$folder/file.ply" "$folder/pipe.ply"
make_ball -write stdout.vdb > "$folder/stream.vdb"
remesh "$folder/stream.vdb:ball" "$folder/stream.ply"
cmp "$folder/file.ply" "$folder/stream.ply"
"$command" "$folder/file.ply" - --stop-after level-set --resolution 48 --vertices 300 --quiet |
  vdb_tool -quiet -read stdin.vdb -ls2mesh -write "$folder/back.ply"
test -s "$folder/back.ply"
# Two level sets as regions, of one file and of two, and as one surface.
pieces() { vdb_tool -quiet -sphere r=0.5 center='(-0.48,0,0)' voxel=0.05 name=piece1 -sphere r=0.5 center='(0.48,0,0)' voxel=0.05 name=piece2 "$@"; }
pieces -write "$folder/pieces.vdb"
remesh "$folder/pieces.vdb:piece*" "$folder/pieces.ply" --require regions,adjacency
grep -aq 'comment region 2 piece2' "$folder/pieces.ply"
remesh "$folder/pieces.vdb:piece1" "$folder/pieces.vdb:piece2" "$folder/two.ply" --require regions
cmp "$folder/pieces.ply" "$folder/two.ply"
remesh "$folder/pieces.vdb:*" "$folder/union.ply" --union --require closed,manifold,components=1
if remesh "$folder/pieces.vdb:piece1" "$folder/no.ply" --union 2> "$folder/why.txt"; then exit 1; fi
grep -q -- '--union is for several level sets' "$folder/why.txt"
cp "$folder/pieces.vdb" "$folder/other.vdb"
if remesh "$folder/pieces.vdb:piece1" "$folder/other.vdb:piece2" "$folder/no.ply" --union --force \
    --save-level-set "$folder/other.vdb" 2> "$folder/why.txt"; then exit 1; fi
grep -q 'named twice' "$folder/why.txt"
cmp "$folder/pieces.vdb" "$folder/other.vdb"
if remesh "$folder/pieces.vdb:*" "$folder/no.ply" --reference "$folder/file.ply" --stats "$folder/file.ply" --force \
    2> "$folder/why.txt"; then exit 1; fi
grep -q 'named twice' "$folder/why.txt"

# The lines of docs/guide/pipelines.md, as they stand there.
page=$(cd "$(dirname "$0")/../.." && pwd)/docs/guide/pipelines.md
mkdir "$folder/page"
cp "$folder/file.ply" "$folder/page/scan.ply"
vdb_tool -quiet -sphere r=0.7 center='(0.81,0.02,0)' voxel=0.05 -ls2mesh -write "$folder/page/part.ply"
(
  cd "$folder/page"
  vdb_tool -quiet -sphere r=1 voxel=0.05 name=surface -grad keep=1 -write both.vdb
  $python -c 'import numpy, pyopenvdb as vdb
pieces = []
surface, v = vdb.read("both.vdb", "surface"), vdb.read("both.vdb", "grad_surface")
v.name = "v"
vdb.write("fluid.vdb", grids=[surface, v])
low, high = surface.evalActiveVoxelBoundingBox()
ball = numpy.empty([b - a + 1 for a, b in zip(low, high)], numpy.float32)
surface.copyToArray(ball, ijk=low)
beyond = (numpy.arange(low[0], high[0] + 1)[:, None, None] + 0.3) * numpy.float32(0.05)  # a plane
for name, side in (("piece1", 1), ("piece2", -1)):
    piece = surface.deepCopy()
    piece.name = name
    piece.copyFromArray(numpy.clip(numpy.maximum(ball, side * beyond), -surface.background, surface.background).astype(numpy.float32), ijk=low)
    pieces.append(piece)
vdb.write("pieces.vdb", grids=pieces)'
  vdb_isomesh() { "$command" "$@" --quiet; }
  sed -n 's/^    \(vdb_\)/\1/p' "$page" > lines.txt
  test "$(wc -l < lines.txt)" -eq 10
  while read -r line; do
    eval "$line" < /dev/null || { echo "docs/guide/pipelines.md: $line"; exit 1; }
  done < lines.txt
)
echo "opened by vdb_print and pyopenvdb, and joined to vdb_tool by a pipe"
