#!/usr/bin/env python3
"""Fields that reach the sides of their arrays, and clouds of open surfaces.

    python3 bench/regions/fields.py

Prints three tables. Fields are a gyroid over two periods, whose volume is known, with sides of each kind, and a ball that falls
onto a side. Clouds are random points of surfaces of known area, with borders kept. CPU seconds are of one thread.
"""
import time
import warnings

import isoshell
import numpy as np


def measured(source, **options):
    start = time.process_time()
    made = isoshell.remesh(source, threads=1, **options)
    return made, time.process_time() - start


def area_of(made):
    a, b, c = (made.vertices[made.faces[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def volume_of(made):
    a, b, c = (made.vertices[made.faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def fields():
    row("gyroid of 64^3, vertices", "sides", "volume, of what is true", "farthest from its box, voxels", "Q",
        "least angle", "below 30 degrees", "CPU s")
    row(*["---"] * 8)
    at = np.linspace(0, 4 * np.pi, 64)
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    values = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
    for sides, longer in (("sample", 0), ("cell", at[1])):
        for vertices in (4000, 10_000, 20_000):
            made, seconds = measured(isoshell.Volume(values, at[1], sides=sides), iso=0, vertices=vertices)
            box = np.array([-longer / 2, 4 * np.pi + longer / 2])
            off = np.abs(np.stack([made.vertices.min(0), made.vertices.max(0)]) - box[:, None]).max() / at[1]
            quality = made.report["quality"]
            row(vertices, sides, f"{volume_of(made) / ((4 * np.pi + longer)**3 / 2):.5f}", f"{off:.3f}",
                f"{quality['q_avg']:.3f}", f"{quality['theta_min_deg']:.1f}", quality["below_30_deg"], f"{seconds:.1f}")


def drop():
    """A ball that falls onto a side of its array, frame by frame."""
    at = np.arange(48.0)
    x, y, z = np.meshgrid(at, at, at, indexing="ij")
    fall = np.zeros((48, 48, 48, 3), np.float32)
    fall[..., 2] = -1.2
    frames = [isoshell.Volume(np.float32(np.hypot(np.hypot(x - 23.5, y - 23.5), z - 22 + 1.2 * k) - 10.3), velocities=fall)
              for k in range(14)]
    print()
    row("a ball that falls onto a side, vertices", "edges kept from frame to frame, %", "least angle of all")
    row(*["---"] * 3)
    for vertices in (3000, 10_000):
        kept, angles = [], []
        with isoshell.remesh_sequence(frames, vertices=vertices) as made:
            for result in made:
                kept += [result.report["coherence"]["kept_edges_pct"]] if result.report["coherence"] else []
                angles.append(result.report["quality"]["theta_min_deg"])
        row(vertices, ", ".join(f"{value:.1f}" for value in kept if value is not None), f"{min(angles):.1f}")


def clouds():
    rng = np.random.default_rng(3)
    square, over = rng.uniform(0, 1, (20_000, 2)), rng.uniform(0, 180, (30_000, 2))
    wall, zero = rng.uniform(0, 4, (8000, 2)), np.zeros(8000)
    ball = rng.normal(size=(20_000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    turn, radius = rng.uniform(0, 2 * np.pi, 40_000), 3 + 27 * rng.uniform(0, 1, 40_000)**2
    height = 8 * np.sin(over[:, 0] / 20) * np.cos(over[:, 1] / 25)
    slope = np.hypot(*np.gradient(8 * np.sin(np.linspace(0, 9, 721))[:, None] * np.cos(np.linspace(0, 7.2, 721)), 0.25))
    cases = {
        "square": (np.c_[square, np.zeros(20_000)], 1),
        "square, noisy": (np.c_[square, 0.002 * rng.normal(size=20_000)], 1),
        "terrain of 180 m": (np.c_[over, height + 0.1 * rng.normal(size=30_000)], 180**2 * np.hypot(1, slope).mean()),
        "corner of a room": (np.r_[np.c_[wall, zero], np.c_[zero, wall], np.c_[wall[:, 0], zero, wall[:, 1]]], 48),
        "ball, whole": (ball, 4 * np.pi),
        "ball above -.2": (ball[ball[:, 2] > -0.2], 2.4 * np.pi),
        "scan of the ground": (np.c_[radius * np.cos(turn), radius * np.sin(turn), 0.02 * rng.normal(size=40_000)],
                               np.pi * 900),
    }
    print()
    row("cloud, 4000 vertices", "area closed, of what is true", "with borders kept", "components", "loops", "Q",
        "least angle", "CPU s")
    row(*["---"] * 8)
    for name, (points, area) in cases.items():
        closed, _ = measured(isoshell.Points(points), vertices=4000)
        made, seconds = measured(isoshell.Points(points), vertices=4000, boundary="keep")
        topology, quality = made.report["topology"], made.report["quality"]
        row(name, f"{area_of(closed) / area:.2f}", f"{area_of(made) / area:.3f}", topology["components"],
            topology["boundary_loops"], f"{quality['q_avg']:.3f}", f"{quality['theta_min_deg']:.1f}", f"{seconds:.1f}")


if __name__ == "__main__":
    warnings.simplefilter("ignore", isoshell.RunWarning)
    fields()
    drop()
    clouds()
