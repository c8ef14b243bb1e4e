#!/usr/bin/env python3
"""Writes the made surfaces that kept borders are measured on.

    bench/shapes/open_surfaces.py FOLDER

half_sphere.off: the upper half of a sphere of radius 1, 128 rings of 512. wavy_sheet.off: 300 x 300 squares over
[-1, 1]^2, .15 sin 5x cos 4y high. Needs numpy.
"""
import pathlib
import sys

import numpy as np


def grid_faces(rows, columns, wraps):
    """Two triangles for each square of a grid of vertices, row by row."""
    faces = []
    for i in range(rows - 1):
        for j in range(columns if wraps else columns - 1):
            k = (j + 1) % columns
            a, b, c, d = i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j
            faces += [(a, b, c), (a, c, d)]
    return faces


def half_sphere(rings=128, around=512):
    tilt = np.linspace(0, np.pi / 2, rings + 1)[:-1]
    turn = np.arange(around) * 2 * np.pi / around
    tilt, turn = np.meshgrid(tilt, turn, indexing="ij")
    points = np.stack([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)], axis=-1).reshape(-1, 3)
    last = (rings - 1) * around
    cap = [(last + j, last + (j + 1) % around, rings * around) for j in range(around)]
    return np.vstack([points, [0, 0, 1]]), grid_faces(rings, around, True) + cap


def wavy_sheet(squares=300):
    x, y = np.meshgrid(np.linspace(-1, 1, squares + 1), np.linspace(-1, 1, squares + 1), indexing="xy")
    z = 0.15 * np.sin(5 * x) * np.cos(4 * y)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), grid_faces(squares + 1, squares + 1, False)


def write_off(path, points, faces):
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        file.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in points)
        file.writelines("3 %d %d %d\n" % f for f in faces)


def main():
    folder = pathlib.Path(sys.argv[1])
    write_off(folder / "half_sphere.off", *half_sphere())
    write_off(folder / "wavy_sheet.off", *wavy_sheet())


if __name__ == "__main__":
    main()
