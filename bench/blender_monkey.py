#!/usr/bin/env python3
"""Blender's monkey by the operator: the figures of bench/results/blender.md with and without seams of UVs as edges, and
the picture docs/images/blender_monkey.png.

    build/bpy/bin/python bench/blender_monkey.py EXTENSION.zip [--picture]

The monkey is below a subdivision modifier of level 2. isoshell.mesh_info judges what Blender exports of each result.
"""

import os
import sys
import tempfile

import bpy
import numpy as np

from blender_operator import export, installed, load
from render import read_mesh, render, write_png

TARGET = os.path.join(os.path.dirname(__file__), "../docs/images/blender_monkey.png")
SIZE, FINER, COUNT = 352, 3, 3000  # drawn so many times finer, for smooth lines
VIEW, UP = np.array((0, -1, 0.05)), np.array((0, 0, 1))
FACE = np.array((0, -0.75, -0.05))  # what the group "fine" is around


def monkey():
    bpy.ops.object.select_all(action="DESELECT")
    obj = load("monkey")
    group = obj.vertex_groups.new(name="fine")
    for vertex in obj.data.vertices:
        away = np.linalg.norm((np.array(vertex.co) - FACE) * (1, 1, 0.75))
        group.add([vertex.index], float(np.clip(1.7 - 2 * away, 0, 1)), "REPLACE")
    return obj


def edges_of(faces):
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def figures(folder, count, keep):
    import isoshell

    obj = monkey()
    source, made = os.path.join(folder, "source.obj"), os.path.join(folder, "made.obj")
    export(source)
    bpy.ops.object.isoshell_remesh(vertices=count, keep_uv_seams=keep)
    export(made)
    info = isoshell.mesh_info(made, ref=source)
    vertices, faces, _, _ = read_mesh(made)
    ends = vertices[edges_of(faces)]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    print(f"{count} vertices, seams {'kept' if keep else 'ignored'}: edges {lengths.min():.4f} to {lengths.max():.4f}")
    for part in ("topology", "quality", "intersections", "distance", "reference"):
        print("   ", part, info.get(part))
    bpy.data.objects.remove(obj)


def panel(obj):
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    mesh.calc_loop_triangles()
    vertices = np.array([tuple(v.co) for v in mesh.vertices])
    faces = np.array([tuple(t.vertices) for t in mesh.loop_triangles])
    drawn = {tuple(sorted(edge.vertices)) for edge in mesh.edges}
    colours = np.full((len(faces), 3), (190, 225, 250))
    fine = render(vertices, faces, colours, set(), SIZE * FINER, VIEW, UP, 1, drawn)
    return fine.reshape(SIZE, FINER, SIZE, FINER, 3).mean((1, 3)).astype(np.uint8)


def picture():
    panels = [panel(monkey())]
    for words in ({}, {"density": "fine", "density_ratio": 3}):
        obj = monkey()
        bpy.ops.object.isoshell_remesh(vertices=COUNT, **words)
        panels.append(panel(obj))
    image = np.concatenate(panels, axis=1)
    inked = np.flatnonzero((image < 255).any((1, 2)))
    write_png(TARGET, image[max(inked[0] - 12, 0):inked[-1] + 13] | 3)


if __name__ == "__main__":
    installed(sys.argv[1])
    if sys.argv[2:] == ["--picture"]:
        picture()
    else:
        for count in (3000, 10000):
            for keep in (False, True):
                with tempfile.TemporaryDirectory() as folder:
                    figures(folder, count, keep)
