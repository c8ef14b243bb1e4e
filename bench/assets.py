#!/usr/bin/env python3
"""What a result keeps of its input's sharp edges and borders, measured from the two files alone.

    bench/assets.py INPUT RESULT [--degrees 25] [--json]

Needs numpy, scipy and trimesh. Nothing of the library is used. Lengths are given in the result's mean edge length e.

- creases: the input's edges whose faces turn by at least --degrees, sampled every e / 10; for each sample the distance
  to the nearest edge of the result whose faces turn by at least half as much. `kept` is the part of the samples within
  .1 e.
- borders: loops of both, the distance of the result's border vertices from the input's borders, and of the input's
  border from the result's.
"""
import argparse
import json

import numpy as np
import trimesh
from scipy.spatial import cKDTree

KEPT = 0.1  # of an edge length


def load(path):
    mesh = trimesh.load(path, process=False, force="mesh")
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=None)
    return mesh


def sharp_edges(mesh, degrees):
    """Pairs of points: the ends of the edges of two faces that turn by at least so many degrees."""
    sharp = mesh.face_adjacency_angles >= np.radians(degrees)
    return mesh.vertices[mesh.face_adjacency_edges[sharp]]


def border_edges(mesh):
    edges = np.sort(mesh.edges, axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    return found[count == 1]


def loops_of(edges):
    """Connected components of border edges."""
    if len(edges) == 0:
        return 0
    return len(list(trimesh.graph.connected_components(edges)))


def samples_along(segments, step):
    """Points along segments, no farther apart than a step, ends included."""
    if len(segments) == 0:
        return np.zeros((0, 3))
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / step).astype(int))
    which = np.repeat(np.arange(len(segments)), count + 1)
    start = np.concatenate([[0], np.cumsum(count + 1)[:-1]])
    along = (np.arange(len(which)) - start[which]) / count[which]
    return segments[which, 0] + (segments[which, 1] - segments[which, 0]) * along[:, None]


def distances(points, segments, step):
    """Of points to the nearest of the segments: exact among those whose samples are nearest."""
    if len(points) == 0:
        return np.zeros(0)
    if len(segments) == 0:
        return np.full(len(points), np.inf)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1)
    count = np.maximum(1, np.ceil(length / step).astype(int))
    which = np.repeat(np.arange(len(segments)), count + 1)
    tree = cKDTree(samples_along(segments, step))
    _, near = tree.query(points, k=min(8, len(which)))
    best = np.full(len(points), np.inf)
    for column in np.atleast_2d(near.T):
        a, b = segments[which[column], 0], segments[which[column], 1]
        ab = b - a
        t = np.einsum("ij,ij->i", points - a, ab) / np.maximum(np.einsum("ij,ij->i", ab, ab), 1e-300)
        foot = a + ab * np.clip(t, 0, 1)[:, None]
        best = np.minimum(best, np.linalg.norm(points - foot, axis=1))
    return best


def summary(d, e):
    if len(d) == 0:
        return None
    return {"samples": len(d), "kept": float(np.mean(d <= KEPT * e)), "mean_e": float(d.mean() / e),
            "max_e": float(d.max() / e)}


def measure(before, after, degrees):
    e = float(after.edges_unique_length.mean())
    step = e / 10
    creases, kept = sharp_edges(before, degrees), sharp_edges(after, degrees / 2)
    rim_before, rim_after = border_edges(before), border_edges(after)
    segments_before, segments_after = before.vertices[rim_before], after.vertices[rim_after]
    return {
        "e": e,
        "creases": summary(distances(samples_along(creases, step), kept, step), e),
        "false_creases": summary(distances(samples_along(sharp_edges(after, degrees), step),
                                           sharp_edges(before, degrees / 2), step), e),
        "border_loops": [loops_of(rim_before), loops_of(rim_after)],
        "border_length": [float(np.linalg.norm(s[:, 1] - s[:, 0], axis=1).sum()) if len(s) else 0.0
                          for s in (segments_before, segments_after)],
        "border": summary(distances(after.vertices[np.unique(rim_after)] if len(rim_after) else np.zeros((0, 3)),
                                    segments_before, step), e),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("input")
    parser.add_argument("result")
    parser.add_argument("--degrees", type=float, default=25)
    parser.add_argument("--json", action="store_true")
    a = parser.parse_args()
    found = measure(load(a.input), load(a.result), a.degrees)
    if a.json:
        print(json.dumps(found))
        return
    for name, value in found.items():
        print(f"{name:14} {value}")


if __name__ == "__main__":
    main()
