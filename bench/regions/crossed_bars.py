#!/usr/bin/env python3
"""Writes bars whose upper faces cross at small angles, as OBJ files for bench/unions.py.

    python3 bench/regions/crossed_bars.py FOLDER

Bars of 2 x .2 x .2, each turned by a share of 180 degrees around z, and tilted by a number of radians more than the one
before: `bars_NUMBER_TILT.obj`.
"""
import sys
from pathlib import Path

import numpy as np

from assemblies import box, write_obj

NUMBERS = (3, 6, 12, 24)
TILTS = (0, 1e-7, 1e-6, 1e-5, 1e-4, 3e-4, 5e-4, 1e-3, 1.5e-3, 2e-3, 3e-3, 1e-2, 3e-2)


def bars(number, tilt_rad):
    vertices, triangles = box((-1, -.1, -.1), (1, .1, .1))
    parts = {}
    for i in range(number):
        turn, tilt = np.pi * i / number, tilt_rad * i
        around_y = np.array([[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])
        around_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        parts[f"bar_{i}"] = (np.array(vertices) @ around_y.T @ around_z.T).tolist(), triangles
    return parts


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for number in NUMBERS:
        for tilt_rad in TILTS:
            write_obj(folder / f"bars_{number}_{tilt_rad:g}.obj", bars(number, tilt_rad))


if __name__ == "__main__":
    main()
