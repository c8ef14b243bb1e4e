#!/usr/bin/env python3
"""Breaks a scan into Voronoi cells of random points, as level sets of one .vdb file, meshes them as regions, and judges.

Needs numpy, OpenVDB's Python module (Debian: python3-openvdb) and the built commands vdb_isomesh and vdb_meshinfo.
Prints a table: vertices, shared walls, slits, volumes against those of the level sets, and shape.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import time

import numpy
import pyopenvdb


def level_set(command, scan, voxels, folder):
    """The scan as a grid, by --stop-after level-set."""
    path = folder / "scan.vdb"
    subprocess.run([command, scan, path, "--stop-after", "level-set", "--resolution", str(voxels), "--quiet", "--force"], check=True)
    return pyopenvdb.read(str(path), "surface")


def dense(grid):
    """Values over the box of the active voxels, and the index of the first one."""
    low, high = (numpy.array(corner) for corner in grid.evalActiveVoxelBoundingBox())
    values = numpy.empty(high - low + 1, numpy.float32)
    grid.copyToArray(values, ijk=tuple(int(i) for i in low))
    return values, low


def grid_of(name, values, low, like):
    """A level set of these values, of which those at the background are not active."""
    grid = pyopenvdb.FloatGrid(background=like.background)
    grid.copyFromArray(values, ijk=tuple(int(i) for i in low), tolerance=0)
    grid.transform = like.transform
    grid.gridClass = pyopenvdb.GridClass.LEVEL_SET
    grid.name = name
    return grid


def points_in(grid, count, seed):
    """Random voxels inside, by their places in the array."""
    inside = numpy.argwhere(dense(grid)[0] < 0)
    return inside[numpy.random.default_rng(seed).choice(len(inside), count, replace=False)].astype(float)


def broken(grid, points, gap_vox):
    """A grid for each cell: the larger of the distance to the scan and to the planes between its point and others."""
    values, low = dense(grid)
    size, band = grid.transform.voxelSize()[0], grid.background
    held = values < band
    index = numpy.argwhere(held).astype(numpy.float32)
    pieces = []
    for own, point in enumerate(points):
        planes = numpy.full(len(index), -numpy.inf, numpy.float32)
        for other in numpy.delete(points, own, axis=0):
            way = other - point
            apart = numpy.linalg.norm(way)
            plane = index @ (way / apart).astype(numpy.float32) - numpy.float32((way / apart) @ (point + other) / 2)
            numpy.maximum(planes, plane + gap_vox / 2, out=planes)
        piece = numpy.full(values.shape, band, numpy.float32)
        piece[held] = numpy.clip(numpy.maximum(values[held], planes * size), -band, band)
        near = numpy.argwhere(piece < band)
        first, last = near.min(axis=0), near.max(axis=0) + 1
        box = tuple(slice(a, b) for a, b in zip(first, last))
        pieces.append(grid_of(f"piece{own:03}", numpy.ascontiguousarray(piece[box]), low + first, grid))
    return pieces


def read_ply(path):
    """Vertices, and of each face its corners, the regions behind and in front, and its material, as vdb_isomesh writes."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    words = [line.split() for line in data[:end].decode().splitlines()]
    counts = [int(line[2]) for line in words if line[0] == "element"]
    number = "<f8" if ["property", "double", "x"] in words else "<f4"
    vertices = numpy.frombuffer(data, number, 3 * counts[0], end).reshape(-1, 3).astype(float)
    face = numpy.dtype([("count", "u1"), ("corners", "<u4", 3), ("pair", "<i4", 2), ("material", "<i4")])
    faces = numpy.frombuffer(data, face, counts[1], end + vertices.size * numpy.dtype(number).itemsize)
    return vertices, faces["corners"].astype(numpy.int64), faces["pair"], faces["material"]


def spanned(vertices, faces):
    """Six times what each face and the origin span."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return numpy.einsum("ij,ij->i", a, numpy.cross(b, c))


def volumes(vertices, faces, pairs, count):
    """Of the regions 1 to `count`, by the divergence theorem."""
    out = numpy.zeros(count + 1)
    numpy.add.at(out, pairs[:, 0], spanned(vertices, faces) / 6)
    numpy.subtract.at(out, pairs[:, 1], spanned(vertices, faces) / 6)
    return out[1:]


def cell_volumes(grid, points, parts=3):
    """Of what is inside of the trilinear field and nearest to each point: by samples `parts` times as dense as voxels."""
    values, _ = dense(grid)
    at = (numpy.arange(parts) + 0.5) / parts
    for axis in range(3):
        near, far = (numpy.take(values, numpy.arange(i, values.shape[axis] - 1 + i), axis)[..., None] for i in (0, 1))
        fine = numpy.moveaxis(near * (1 - at) + far * at, -1, axis + 1)
        values = fine.reshape(*fine.shape[:axis], -1, *fine.shape[axis + 2:]).astype(numpy.float32)
    inside = numpy.argwhere(values < 0).astype(numpy.float32)
    seeds = (points * parts - 0.5).astype(numpy.float32)  # sample s is at (s + 1/2) / parts
    counts = numpy.zeros(len(points))
    for chunk in numpy.array_split(inside, len(inside) // 500_000 + 1):
        nearest = ((seeds**2).sum(axis=1) - 2 * chunk @ seeds.T).argmin(axis=1)
        counts += numpy.bincount(nearest, minlength=len(points))
    return counts * (grid.transform.voxelSize()[0] / parts) ** 3


def open_regions(faces, pairs, count):
    """How many of the regions have an edge without exactly two faces, which run through it both ways."""
    found = 0
    for label in range(1, count + 1):
        own = numpy.concatenate([faces[pairs[:, 0] == label], faces[pairs[:, 1] == label][:, ::-1]])
        edges = numpy.concatenate([own[:, [0, 1]], own[:, [1, 2]], own[:, [2, 0]]])
        backwards = {(int(b), int(a)) for a, b in edges}
        found += len(backwards) != len(edges) or backwards != {(int(a), int(b)) for a, b in edges}
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scan", type=pathlib.Path)
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/cpu"), help="folder of the commands")
    parser.add_argument("--resolution", type=int, default=256, help="voxels along the longest side")
    parser.add_argument("--pieces", type=int, default=64)
    parser.add_argument("--gaps", type=float, nargs="*", default=[0, 0.5], help="between pieces, in voxels; below 0 they overlap")
    parser.add_argument("--vertices", type=int, nargs="*", default=[50000])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the files")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = args.keep or pathlib.Path(made)
        folder.mkdir(exist_ok=True)
        scan = level_set(args.bin / "vdb_isomesh", args.scan, args.resolution, folder)
        print("| gap, voxels | vertices | seconds | regions open | crossings | inner faces of one piece, % | largest volume error, % "
              "| all volumes, % | Q | least angle | below 30, % |\n|" + " --- |" * 11)
        points = points_in(scan, args.pieces, args.seed)
        wanted = cell_volumes(scan, points)
        for gap in args.gaps:
            pyopenvdb.write(str(folder / "pieces.vdb"), broken(scan, points, gap))
            for vertices in args.vertices:
                print(row(args, folder, wanted, gap, vertices), flush=True)


def row(args, folder, wanted, gap, vertices):
    out = folder / f"pieces_{gap}_{vertices}.ply"
    begin = time.monotonic()
    subprocess.run([args.bin / "vdb_isomesh", f"{folder}/pieces.vdb:piece*", out, "--vertices", str(vertices), "--reference",
                    folder / "scan.vdb", "--stats", folder / "stats.json", "--force", "--quiet"], check=True)
    seconds = time.monotonic() - begin
    stats = json.loads((folder / "stats.json").read_text())
    points, faces, pairs, material = read_ply(out)
    area = numpy.linalg.norm(numpy.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1)
    inner = material == 1
    lonely = area[inner & (pairs == 0).any(axis=1)].sum() / area[inner].sum()
    found = volumes(points, faces, pairs, len(wanted))
    error = numpy.abs(found / wanted - 1)
    quality = stats["quality"]
    return (f"| {gap} | {len(points):,} | {seconds:.1f} | {open_regions(faces, pairs, len(wanted))} | "
            f"{stats['regions']['self_intersecting_pairs']} | {100 * lonely:.2f} | {100 * error.max():.2f} | "
            f"{100 * (found.sum() / wanted.sum() - 1):+.2f} | {quality['q_avg']:.3f} | {quality['theta_min_deg']:.1f} | "
            f"{quality['below_30_deg_pct']:.2f} |")


if __name__ == "__main__":
    main()
