#!/usr/bin/env python3
"""Counts results whose angles are all 30 degrees or more, but at wedges and strips that the input has itself.

    python3 bench/part_angles.py vdb_isomesh FILE... [--vertices 4000] [--jobs 2]

Needs numpy, scipy and trimesh. A place on creases (30 degrees and more) is at a wedge or strip if another one is nearer
than half an edge of the result, and farther along creases than sides of 30 degrees take. Triangles with a corner within
half an edge of such a place do not count.
"""
import argparse
import math
import os
import subprocess
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy
import trimesh
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

LEAST_DEGREES = 30
CREASE_DEGREES = 30
STEPS_OF_EDGE = 8
WAY_OVER_DISTANCE = 1 / math.sin(math.radians(LEAST_DEGREES / 2))
ROWS = 512  # of distances at once


def smallest_angles(mesh):
    return numpy.degrees(mesh.face_angles.min(axis=1))


def points_on_creases(mesh, step):
    """Points (n, 3) on edges that turn, and the ways between neighbours (n, n), sparse."""
    sharp = mesh.face_adjacency_edges[mesh.face_adjacency_angles >= math.radians(CREASE_DEGREES)]
    points, number, ways = [], {}, []

    def add(point):
        points.append(point)
        return len(points) - 1

    for ends in sharp:
        a, b = (mesh.vertices[v] for v in ends)
        count = max(1, math.ceil(numpy.linalg.norm(b - a) / step))
        last = None
        for i in range(count + 1):
            end = ends[0] if i == 0 else ends[1] if i == count else None
            here = add(a + (b - a) * i / count) if end is None else number.setdefault(end, len(points))
            if end is not None and here == len(points):
                add(mesh.vertices[end])
            if last is not None:
                ways.append((last, here, numpy.linalg.norm(b - a) / count))
            last = here
    if not points:
        return numpy.zeros((0, 3)), None
    i, j, way = zip(*ways)
    return numpy.array(points), coo_matrix((way, (i, j)), shape=(len(points), len(points))).tocsr()


def narrow_places(mesh, edge):
    """Points (n, 3) of creases at wedges and strips."""
    points, ways = points_on_creases(mesh, edge / STEPS_OF_EDGE)
    if len(points) == 0:
        return points
    near = cKDTree(points).query_pairs(edge / 2, output_type="ndarray")
    is_narrow = numpy.zeros(len(points), bool)
    for begin in range(0, len(points), ROWS):
        here = near[(near[:, 0] >= begin) & (near[:, 0] < begin + ROWS)]
        if len(here) == 0:
            continue
        rows = range(begin, min(begin + ROWS, len(points)))
        along = dijkstra(ways, directed=False, indices=rows, limit=WAY_OVER_DISTANCE * edge)
        distance = numpy.linalg.norm(points[here[:, 0]] - points[here[:, 1]], axis=1)
        found = here[along[here[:, 0] - begin, here[:, 1]] > WAY_OVER_DISTANCE * distance]
        is_narrow[found.ravel()] = True
    return points[is_narrow]


def counted_angles(source, result):
    """The smallest angle, the smallest one that counts, and how many triangles that count are below 30 degrees."""
    angles = smallest_angles(result)
    edge = float(numpy.median(result.edges_unique_length))
    poor = numpy.flatnonzero(angles < LEAST_DEGREES)
    places = narrow_places(source, edge) if len(poor) else []
    if len(places):
        distance, _ = cKDTree(places).query(result.vertices[result.faces[poor]])
        poor = poor[distance.min(axis=1) > edge / 2]
    return angles.min(), angles[poor].min() if len(poor) else LEAST_DEGREES, len(poor)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("files", nargs="+")
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()

    def row(path):
        with tempfile.TemporaryDirectory() as folder:
            made = os.path.join(folder, "result.ply")
            run = subprocess.run([options.program, path, made, "-q", "--vertices", str(options.vertices)],
                                 capture_output=True, text=True)
            if run.returncode:
                return path, None
            load = lambda name: trimesh.load(name, process=True, force="mesh")
            return path, counted_angles(load(path), load(made))

    with ThreadPoolExecutor(options.jobs) as pool:
        rows = list(pool.map(row, options.files))
    print("| file | smallest angle | smallest that counts | triangles that count |\n|---|---|---|---|")
    for path, angles in rows:
        if angles is None or angles[2]:
            values = "no mesh | | " if angles is None else f"{angles[0]:.1f} | {angles[1]:.1f} | {angles[2]}"
            print(f"| {os.path.basename(path)} | {values} |")
    good = sum(angles is not None and angles[2] == 0 for _, angles in rows)
    wide = sum(angles is not None and angles[0] >= LEAST_DEGREES for _, angles in rows)
    print(f"{len(rows)} files: {good} with all angles that count from 30 degrees on, {wide} with all angles")


if __name__ == "__main__":
    main()
