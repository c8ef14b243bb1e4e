#!/usr/bin/env python3
"""Periodic volumes of labels: are opposite sides the same, and what does it cost?

    python3 bench/regions/periodic.py [FIRST LAST]

Makes periodic grains, of random sizes, axes, voids and counts, with these seeds (0 to 110), and prints for each whose sides
differ, that is refused or has another count a line, and then how many there were. Then a table of grains with and without
--periodic: least angles, the dihedral angle between walls, CPU seconds of one thread, and what TetGen fills.
"""
import sys
import time
import warnings

import isoshell
import numpy as np

AXES = ["x", "y", "z", "x,y", "y,z", "x,z", "x,y,z", "x,y,z"]


def grains(n, count, seed, axes, voids=0):
    """Each voxel has the label of the nearest of some random points, around the sides along these axes."""
    labels, best = np.zeros((n, n, n), np.int32), np.full((n, n, n), np.inf)
    at = np.stack(np.meshgrid(*[np.arange(n) + .5] * 3, indexing="ij"), axis=-1)
    for label, point in enumerate(np.random.default_rng(seed).random((count, 3)) * n, 1):
        way = np.abs(at - point)
        for axis, name in enumerate("xyz"):
            if name in axes:
                way[..., axis] = np.minimum(way[..., axis], n - way[..., axis])
        distance = (way**2).sum(-1)
        labels[distance < best] = label
        best = np.minimum(best, distance)
    labels[labels <= voids] = 0
    return labels


def are_same(made, axes):
    """Whether opposite sides have the same triangles, to the last bit of their other coordinates."""
    for axis, name in enumerate("xyz"):
        if name not in axes:
            continue
        along = made.vertices[:, axis]
        sides = []
        for end in (along.min(), along.max()):
            faces = made.faces[(along[made.faces] == end).all(1)]
            sides.append({frozenset(map(tuple, np.delete(corners, axis, 1))) for corners in made.vertices[faces]})
        if not sides[0] or sides[0] != sides[1]:
            return False
    return True


def try_random(first, last):
    same = refused = other_count = 0
    for seed in range(first, last):
        rng = np.random.default_rng(seed)
        n, count, axes = int(rng.integers(16, 56)), int(rng.integers(2, 60)), AXES[rng.integers(8)]
        voids, vertices = count // 4 * int(rng.integers(2)), int(rng.choice([300, 1000, 3000, 8000]))
        what = f"seed {seed}: {count} grains, {voids} void, in {n}^3, along {axes}, {vertices} vertices"
        try:
            made = isoshell.remesh(isoshell.Labels(grains(n, count, seed, axes, voids), periodic=axes), vertices=vertices)
        except isoshell.Error as error:
            refused += 1
            print(what, "refused:", error)
            continue
        is_same = are_same(made, axes)
        same += is_same
        other_count += len(made.vertices) != vertices
        if not is_same:
            print(what, "sides differ")
    print(f"{last - first} volumes: {same} with equal sides, {refused} refused, {other_count} with another count")


def compare():
    print("| grains | vertices | periodic | least angle | below 30 degrees | between walls | CPU s | filled |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for n, count, seed, vertices in [(48, 20, 1, 4000), (48, 20, 1, 10000), (64, 64, 2, 20000), (96, 100, 3, 40000)]:
        labels = grains(n, count, seed, "xyz")
        for periodic in ("", "x,y,z"):
            start = time.process_time()
            made = isoshell.remesh(isoshell.Labels(labels, periodic=periodic), vertices=vertices, threads=1)
            seconds = time.process_time() - start
            quality = made.report["quality"]
            filled = made.fill("tetgen")
            regions = made.report["regions"]["regions"]
            volume = sum(region["volume"] for region in regions)
            inside = sum(filled.volume(region["label"]) for region in regions)
            print(f"| {count} in {n}^3 | {vertices} | {periodic or 'no'} | {quality['theta_min_deg']:.1f} | "
                  f"{quality['below_30_deg']} | {quality['dihedral_min_deg']:.1f} | {seconds:.1f} | "
                  f"{100 * inside / volume:.2f} % |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    try_random(*map(int, sys.argv[1:3]) if len(sys.argv) > 2 else (0, 110))
    compare()
