#!/usr/bin/env python3
"""What fillers of regions stumble over: angles between walls, volumes of small regions, parts that nearly touch.

    python3 bench/regions/fillable.py

Prints two tables: of 200 volumes of region_volumes.py together the least angle between two walls and how volumes of regions
change; and of a pin in a plate, with gaps between them, whether they share a wall. CPU seconds are of one thread. bars.py has
volumes as people have them, one by one.
"""
import time
import warnings

import isoshell
import numpy as np
from region_volumes import RANDOM_VOLUMES, random_labels

LARGE_VOXELS = 30  # regions with more are to keep their volume to 2 %


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def measured(source, **options):
    start = time.process_time()
    made = isoshell.remesh(source, threads=1, **options)
    return made, time.process_time() - start


def of_random():
    row("200 random volumes, vertices", "walls below 5 degrees", "below 10", "large regions that change by more than 2 %")
    row(*["---"] * 4)
    for vertices in (500, 4000):
        angles, regions = [], 0
        for seed in range(RANDOM_VOLUMES):
            made = isoshell.remesh(isoshell.Labels(random_labels(seed)), vertices=vertices, threads=1)
            angles.append(made.report["quality"]["dihedral_min_deg"])
            regions += sum(v["volume_before"] > LARGE_VOXELS for v in made.report["regions"]["volumes_changed"])
        row(vertices, sum(a < 5 for a in angles), sum(a < 10 for a in angles), regions)


def prism(radius, sides, hole=0):
    """From z = 0 to 8, with a hole of as many sides where it has a radius."""
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    rings = [radius * ring] + ([hole * ring] if hole else [])
    points = np.concatenate([np.column_stack([r, np.full(sides, z)]) for r in rings for z in (0., 8.)])
    faces = []
    for first, other, outward in [(0, sides, True)] + ([(2 * sides, 3 * sides, False)] if hole else []):
        for i in range(sides):
            a, b, c, d = first + i, first + (i + 1) % sides, other + (i + 1) % sides, other + i
            faces += [(a, b, c), (a, c, d)] if outward else [(a, c, b), (a, d, c)]
    for level, up in ((0, False), (sides, True)):
        for i in range(1, sides - 1) if not hole else range(sides):
            j = (i + 1) % sides
            made = [(level, level + i, level + i + 1)] if not hole else [
                (level + i, level + j, level + 2 * sides + j), (level + i, level + 2 * sides + j, level + 2 * sides + i)]
            faces += made if up else [(a, c, b) for a, b, c in made]
    return points, np.array(faces)


def pin_in_plate(gap):
    plate, plate_faces = prism(20, 48, hole=6)
    pin, pin_faces = prism(6 - gap, 48)
    parts = np.repeat([1, 2], [len(plate_faces), len(pin_faces)])
    return isoshell.Mesh(np.concatenate([plate, pin]), np.concatenate([plate_faces, pin_faces + len(plate)]),
                         of_faces={"part": parts})


def of_gaps():
    row("a pin of radius 6 in a plate, gap", "vertices made of 6000", "area of their wall", "named", "least angle", "CPU s")
    row(*["---"] * 6)
    for gap in (0, 5e-6, 2e-5, 1e-4, 1e-3, .05):
        made, seconds = measured(pin_in_plate(gap), regions="part", vertices=6000)
        walls = {tuple(wall["labels"]): wall["area"] for wall in made.report["regions"]["walls"]}
        row(gap, len(made.vertices), f"{walls.get((1, 2), 0):.2f}",
            "yes" if any("share no wall" in text for text in made.report["warnings"]) else "no",
            f"{made.report['quality']['theta_min_deg']:.1f}", f"{seconds:.1f}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    of_random()
    print()
    of_gaps()
