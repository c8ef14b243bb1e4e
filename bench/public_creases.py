#!/usr/bin/env python3
"""How much of the sharp edges of parts is on curves of the result.

    python3 bench/public_creases.py MESH ...

Of the length of edges where faces turn by more than 40 degrees, the part with a curve within a quarter of an edge of the
result, at 10,000 vertices. Needs trimesh and scipy.
"""
import pathlib
import sys
import warnings

import isoshell
import numpy as np
import trimesh
from scipy.spatial import cKDTree

SHARP_DEG, NEAR, VERTICES = 40, 0.25, 10_000


def along(vertices, edges, places):
    start, end = vertices[edges[:, 0]], vertices[edges[:, 1]]
    return start[:, None] + places[None, :, None] * (end - start)[:, None]


def main():
    warnings.simplefilter("ignore", isoshell.RunWarning)
    print("| part | faces | of the length of sharp edges, % | least angle |")
    print("| --- | --- | --- | --- |")
    for path in sys.argv[1:]:
        mesh = trimesh.load(path, force="mesh", process=True)
        mesh.merge_vertices(merge_norm=True, merge_tex=True)
        edges = mesh.face_adjacency_edges[np.degrees(mesh.face_adjacency_angles) > SHARP_DEG]
        lengths = np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1)
        made = isoshell.remesh(path, vertices=VERTICES, threads=1)
        curves = made.features["curve_edges"]
        found = np.zeros(0)
        if len(curves) and len(edges):
            tree = cKDTree(along(made.vertices, curves, np.linspace(0, 1, 9)).reshape(-1, 3))
            edge = np.median(np.linalg.norm(made.vertices[made.faces[:, 0]] - made.vertices[made.faces[:, 1]], axis=1))
            places = np.linspace(0.05, 0.95, 7)
            away = tree.query(along(mesh.vertices, edges, places).reshape(-1, 3))[0].reshape(len(edges), -1)
            found = lengths * (away < NEAR * edge).mean(axis=1)
        print(f"| {pathlib.Path(path).stem} | {len(mesh.faces)} | {100 * found.sum() / max(lengths.sum(), 1e-300):.1f} | "
              f"{made.report['quality']['theta_min_deg']:.1f} |", flush=True)


if __name__ == "__main__":
    main()
