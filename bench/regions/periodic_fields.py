#!/usr/bin/env python3
"""Periodic fields: are opposite sides the same, and what are the triangles like?

    python3 bench/regions/periodic_fields.py [FIRST LAST]

Sums of a few waves with these seeds (0 to 48), in arrays of random sizes: as they are, sheets on both sides of 0, steps,
and with a seventh or six sevenths inside; for each whose sides differ, that is refused or has another count a line, and
then how many there were. Then a table of gyroids, network and sheet.
"""
import sys
import time
import warnings

import isoshell
import numpy as np

from periodic import AXES, are_same


def phases(shape):
    return np.meshgrid(*[2 * np.pi * np.arange(n) / n for n in shape], indexing="ij")


def waves(seed):
    rng = np.random.default_rng(seed)
    at = phases(rng.integers(12, 56, 3))
    field = np.zeros(at[0].shape)
    for _ in range(rng.integers(3, 9)):
        turns = rng.integers(-2, 3, 3)
        field += rng.normal() * np.cos(sum(t * x for t, x in zip(turns, at)) + rng.uniform(0, 2 * np.pi))
    return (field, np.abs(field) - np.quantile(np.abs(field), .3), np.round(2 * field) / 2,
            field - np.quantile(field, .15), field - np.quantile(field, .85))[seed % 5]


def try_random(first, last):
    same = refused = other_count = 0
    least = []
    for seed in range(first, last):
        field, axes, vertices = waves(seed), AXES[seed % 8], (300, 1000, 3000, 8000)[seed % 4]
        what = f"seed {seed}, kind {seed % 5}, {field.shape}, along {axes}, {vertices} vertices"
        spacing = (1, 1 if seed % 3 else 2, 1)
        volume = isoshell.Volume(field, spacing=spacing, periodic=axes)
        try:
            made = isoshell.remesh(volume, iso=0, vertices=vertices)
        except isoshell.Error as error:
            refused += 1
            print(what, "refused:", error)
            continue
        size = made.vertices.max(axis=0) - made.vertices.min(axis=0)
        reached = [a for a, of, n, step in zip("xyz", size, field.shape, spacing) if a in axes and of > n * step - 1e-6]
        is_same = are_same(made, reached)
        same += is_same
        other_count += len(made.vertices) != vertices
        least.append(made.report["quality"]["theta_min_deg"])
        if not is_same:
            print(what, "sides differ")
    print(f"{last - first} fields: {same} with equal sides, {refused} refused, {other_count} with another count, "
          f"least angle {np.median(least):.1f} degrees in the median")


def compare():
    print("| gyroid | vertices | periodic | Q | least angle | below 30 degrees | volume | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for n, vertices in [(32, 4000), (64, 20000), (96, 50000)]:
        x, y, z = phases((n, n, n))
        network = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        for name, field in (("network", network), ("sheet", np.abs(network) - .4)):
            for periodic in ("", "x,y,z"):
                start = time.process_time()
                made = isoshell.remesh(isoshell.Volume(field, spacing=1 / n, periodic=periodic), iso=0, vertices=vertices,
                                       threads=1)
                seconds = time.process_time() - start
                quality, corners = made.report["quality"], made.vertices[made.faces]
                volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
                print(f"| {name}, {n}^3 | {vertices} | {periodic or 'no'} | {quality['q_avg']:.3f} | "
                      f"{quality['theta_min_deg']:.1f} | {quality['below_30_deg']} | {volume:.5f} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    try_random(*map(int, sys.argv[1:3]) if len(sys.argv) > 2 else (0, 48))
    compare()
