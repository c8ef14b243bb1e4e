#!/usr/bin/env python3
"""Sequences of surfaces whose creases and seams have to stay: frames with the same faces, in FOLDER/NAME/frame.####.obj.

    python3 bench/moving_parts.py FOLDER [MESH.off] [FRAMES=24]

- box: a box whose lid opens, two bodies with sharp edges.
- gear: a gear that turns, and bends more and more.
- walk: MESH with texture coordinates of two charts, front and back, that sways and goes forward.

Needs numpy; gear and box also manifold3d.
"""
import math
import pathlib
import sys

import numpy as np
from manifold3d import CrossSection, Manifold


def arrays_of(solid):
    mesh = solid.to_mesh()
    return np.asarray(mesh.vert_properties, float)[:, :3], np.asarray(mesh.tri_verts, int)


def write_obj(path, vertices, faces, uv=None, uv_faces=None):
    with open(path, "w") as file:
        np.savetxt(file, vertices, "v %.9g %.9g %.9g")
        if uv is None:
            np.savetxt(file, faces + 1, "f %d %d %d")
        else:
            np.savetxt(file, uv, "vt %.7g %.7g")
            np.savetxt(file, np.stack([faces + 1, uv_faces + 1], 2).reshape(len(faces), 6), "f %d/%d %d/%d %d/%d")


def turned_about(vertices, angle, first, second, center=(0, 0)):
    """In the plane of two axes."""
    out = vertices.copy()
    u, w = vertices[:, first] - center[0], vertices[:, second] - center[1]
    out[:, first] = math.cos(angle) * u - math.sin(angle) * w + center[0]
    out[:, second] = math.sin(angle) * u + math.cos(angle) * w + center[1]
    return out


def bent(vertices, curvature, along, up):
    """A circle of the bent axis goes on in the plane of both axes."""
    out, angle, height = vertices.copy(), vertices[:, along] * curvature, vertices[:, up]
    half = np.sinc(angle / (2 * np.pi)) ** 2 * vertices[:, along] ** 2 * curvature / 2  # (1 - cos(angle)) / curvature
    out[:, along] = np.sinc(angle / np.pi) * vertices[:, along] - height * np.sin(angle)
    out[:, up] = half + height * np.cos(angle)
    return out


def box_frames(count):
    box = Manifold.cube([4, 3, 1.6]) - Manifold.cube([3.4, 2.4, 1.6]).translate([0.3, 0.3, 0.3])
    lid = Manifold.cube([4, 3, 0.3]).translate([0, 0, 1.9])
    (v, f), (lid_v, lid_f) = arrays_of(box), arrays_of(lid)
    for t in range(count):
        moved = turned_about(lid_v, -0.05 * t, 1, 2, (3, 2.2))
        yield np.vstack([v, moved]), np.vstack([f, lid_f + len(v)]), None, None


def gear_frames(count, teeth=14):
    outline = []
    for tooth in range(teeth):
        for radius, part in ((1.6, 0.0), (1.6, 0.45), (2, 0.58), (2, 0.87)):
            angle = 2 * math.pi * (tooth + part) / teeth
            outline.append((radius * math.cos(angle), radius * math.sin(angle)))
    gear = Manifold.extrude(CrossSection([outline]), 0.8) - Manifold.cylinder(0.8, 0.6, circular_segments=48)
    v, f = arrays_of(gear.refine_to_length(0.4))
    for t in range(count):
        yield bent(turned_about(v, 0.04 * t, 0, 1), 0.012 * t, 0, 2), f, None, None


def walk_frames(count, path):
    words = open(path).read().split()
    n, m = int(words[1]), int(words[2])
    v = np.array(words[4:4 + 3 * n], float).reshape(n, 3)
    f = np.array(words[4 + 3 * n:4 + 3 * n + 4 * m], int).reshape(m, 4)[:, 1:]
    low, high = v.min(0), v.max(0)
    up = int(np.argmax(high - low))
    side, ahead = [a for a in range(3) if a != up]
    is_back = v[f].mean(1)[:, ahead] > (low + high)[ahead] / 2
    chart = (v - low)[:, [side, up]] / (high - low)[up] * 0.49
    uv, uv_faces = np.vstack([chart, chart + [0.5, 0]]), f + n * is_back[:, None]
    v = v - (low + high) / 2
    size = (high - low)[up]
    for t in range(count):
        sway = 0.25 * math.sin(2 * math.pi * t / 16)
        moved = bent(v, sway / size, up, side)
        height = moved[:, up] / size
        moved[:, ahead] += size * (0.01 * t + 0.06 * height * math.sin(2 * math.pi * t / 12))
        yield moved, f, uv, uv_faces


def main():
    folder = pathlib.Path(sys.argv[1])
    mesh = sys.argv[2] if len(sys.argv) > 2 else None
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 24
    sequences = {"box": box_frames(count), "gear": gear_frames(count)}
    if mesh:
        sequences["walk"] = walk_frames(count, mesh)
    for name, frames in sequences.items():
        (folder / name).mkdir(parents=True, exist_ok=True)
        for t, (vertices, faces, uv, uv_faces) in enumerate(frames):
            write_obj(folder / name / f"frame.{t:04}.obj", vertices, faces, uv, uv_faces)


if __name__ == "__main__":
    main()
