#!/usr/bin/env python3
"""Writes parts with one thing wrong each, to see how many of their creases a run keeps.

    python3 bench/dirty_parts.py FOLDER [--seed 1] FILE...

Needs numpy and trimesh. Of every file: `hole` lacks the faces around a point, `triangle` one face, `face` a whole flat
one, `flipped` has one that looks inwards, `fin` a triangle that stands on an edge, `wall` one across a loop of its
edges, `through` a second copy that passes through it, `twice` a flat face two times.
"""
import argparse
from pathlib import Path

import numpy
import trimesh


def flat_face(mesh, random):
    """The triangles of a random flat face, the larger the likelier, but not of more than a third of the surface."""
    labels, before = numpy.arange(len(mesh.faces)), None
    a, b = mesh.face_adjacency[mesh.face_adjacency_angles < 1e-4].T
    while before is None or (labels != before).any():
        before = labels.copy()
        numpy.minimum.at(labels, a, before[b])
        numpy.minimum.at(labels, b, before[a])
    areas = numpy.bincount(labels, weights=mesh.area_faces, minlength=len(labels))
    areas[areas > mesh.area / 3] = 0
    return numpy.flatnonzero(labels == random.choice(len(areas), p=areas / areas.sum()))


def without(mesh, faces):
    return trimesh.Trimesh(mesh.vertices, numpy.delete(mesh.faces, faces, axis=0), process=False)


def hole(mesh, random):
    edge = mesh.scale / 60
    vertices, faces = trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, edge, max_iter=12)
    fine = trimesh.Trimesh(vertices, faces)  # merges what was divided from both sides
    at = fine.triangles_center[random.choice(len(fine.faces), p=fine.area_faces / fine.area)]
    near = numpy.linalg.norm(fine.triangles_center - at, axis=1) < 2 * edge
    return without(fine, numpy.flatnonzero(near))


def triangle(mesh, random):
    return without(mesh, [random.choice(len(mesh.faces), p=mesh.area_faces / mesh.area)])


def face(mesh, random):
    return without(mesh, flat_face(mesh, random))


def flipped(mesh, random):
    faces = mesh.faces.copy()
    patch = flat_face(mesh, random)
    faces[patch] = faces[patch][:, ::-1]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


def fin(mesh, random):
    f = random.choice(len(mesh.faces), p=mesh.area_faces / mesh.area)
    a, b, _ = mesh.faces[f]
    tip = mesh.triangles_center[f] + mesh.face_normals[f] * mesh.scale / 30
    return trimesh.Trimesh(numpy.vstack([mesh.vertices, tip]),
                           numpy.vstack([mesh.faces, [a, b, len(mesh.vertices)]]), process=False)


def wall(mesh, random):
    """A flat face a second time, over the same border and bent through the inside: its edges have three faces."""
    patch = flat_face(mesh, random)
    border = trimesh.grouping.group_rows(numpy.sort(mesh.faces[patch][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1),
                                         require_count=1)
    edges = mesh.faces[patch][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)[border]
    middle = mesh.triangles_center[patch].mean(axis=0) - mesh.face_normals[patch[0]] * mesh.scale / 100
    tip = len(mesh.vertices)
    return trimesh.Trimesh(numpy.vstack([mesh.vertices, middle]),
                           numpy.vstack([mesh.faces, [[b, a, tip] for a, b in edges]]), process=False)


def through(mesh, random):
    other = mesh.copy()
    other.apply_transform(trimesh.transformations.rotation_matrix(random.uniform(.3, 1), random.normal(size=3),
                                                                  mesh.bounds.mean(axis=0)))
    other.apply_translation(mesh.extents * random.uniform(.1, .4, 3))
    return trimesh.util.concatenate([mesh, other])


def twice(mesh, random):
    return trimesh.Trimesh(mesh.vertices, numpy.vstack([mesh.faces, mesh.faces[flat_face(mesh, random)]]), process=False)


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("folder", type=Path)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("files", nargs="+", type=Path)
    a = p.parse_args()
    a.folder.mkdir(parents=True, exist_ok=True)
    for path in a.files:
        mesh = trimesh.load_mesh(path, process=True)
        mesh.merge_vertices(merge_tex=True, merge_norm=True)
        for make in (hole, triangle, face, flipped, fin, wall, through, twice):
            make(mesh, numpy.random.default_rng([a.seed, len(mesh.faces)])).export(a.folder / f"{path.stem}_{make.__name__}.ply")


if __name__ == "__main__":
    main()
