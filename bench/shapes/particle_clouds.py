#!/usr/bin/env python3
"""Writes clouds of surfaces with noise and clouds that fill volumes, which bench_particles tells apart.

    bench/shapes/particle_clouds.py FOLDER && build/cpu/bench/bench_particles FOLDER/*.xyz

Surfaces are a ball, a terrain, a thin box of two sides and a scan from one place with rings far apart, each with noise of 0 to
2.5 spacings. Volumes are a ball and a splash, at random and on a grid, and pools 2 to 16 particles deep. Needs numpy.
"""
import pathlib
import sys

import numpy as np

COUNT = 8000


def surfaces(rng):
    at = np.arange(COUNT) + .5
    height, turn = 1 - 2 * at / COUNT, np.pi * (1 + 5**.5) * at
    ring = np.sqrt(1 - height**2)
    flat = rng.uniform(0, 1, (COUNT, 2))
    side = np.where(np.arange(COUNT) % 2, .08, 0.)
    ways, tilts = np.meshgrid(np.linspace(0, 2 * np.pi, COUNT // 32), np.linspace(.05, .5, 32))
    far = 1 / np.tan(tilts.ravel())
    yield "ball", np.c_[ring * np.cos(turn), ring * np.sin(turn), height], np.sqrt(4 * np.pi / COUNT)
    yield "terrain", np.c_[flat, .1 * np.sin(7 * flat[:, 0]) * np.cos(5 * flat[:, 1])], np.sqrt(1 / COUNT)
    yield "two sides", np.c_[flat, side], np.sqrt(2 / COUNT)
    yield "rings of a scan", np.c_[far * np.cos(ways.ravel()), far * np.sin(ways.ravel()), 0 * far], .06


def volumes(rng):
    inside = rng.uniform(-1, 1, (2 * COUNT, 3))
    yield "volume, ball at random", inside[(inside**2).sum(1) < 1][:COUNT]
    side = np.linspace(0, 1, 20)
    lattice = np.stack(np.meshgrid(side, side, side), -1).reshape(-1, 3)
    yield "volume, lattice", lattice
    yield "volume, lattice moved", lattice + rng.uniform(-.3, .3, lattice.shape) / 20
    drops = [rng.normal(size=(150, 3)) * .03 + middle for middle in rng.uniform(0, 1, (50, 3))]
    yield "volume, splash of 50 drops", np.concatenate(drops)
    for deep in (2, 3, 4, 6, 8, 16):
        wide = int((COUNT / deep)**.5)
        pool = np.stack(np.meshgrid(np.arange(wide), np.arange(wide), np.arange(deep)), -1).reshape(-1, 3)
        yield f"volume, pool {deep:02} deep", pool + rng.uniform(-.3, .3, pool.shape)


def main():
    folder, rng = pathlib.Path(sys.argv[1]), np.random.default_rng(1)
    folder.mkdir(parents=True, exist_ok=True)
    for name, points, spacing in surfaces(rng):
        for noise in (0, .5, 1, 1.5, 2, 2.5):
            moved = points + noise * spacing * rng.uniform(-1, 1, points.shape)
            np.savetxt(folder / f"{name}, noise {noise}.xyz", moved, fmt="%.6g")
    for name, points in volumes(rng):
        np.savetxt(folder / f"{name}.xyz", points, fmt="%.6g")


if __name__ == "__main__":
    main()
