#!/usr/bin/env python3
"""What fillers of regions stumble over: angles between walls, volumes of small regions, parts that nearly touch.

    python3 bench/regions/fillable.py [LABELS.npz ...]

Prints three tables: of volumes of labels (arrays `labels` and `affine` of the files, a ball with small lesions, and 200 of
region_volumes.py together) the least angle between two walls and how volumes of regions change; and of a pin in a plate, with
gaps between them, whether they share a wall. CPU seconds are of one thread.
"""
import pathlib
import sys
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


def lesions():
    """A ball of three shells with 24 ellipsoids of 10 to 200 voxels in it."""
    rng = np.random.default_rng(5)
    at = np.stack(np.meshgrid(*[np.arange(96.0)] * 3, indexing="ij"), axis=-1) - 48
    radius = np.linalg.norm(at / (40, 34, 36), axis=-1)
    labels = (radius < 1).astype(np.int32) + (radius < .8) + (radius < .3)
    for label in range(4, 28):
        way = rng.normal(size=3)
        middle = way / np.linalg.norm(way) * rng.uniform(8, 36)
        labels[(np.linalg.norm((at - middle) / rng.uniform(1.3, 3.5, 3), axis=-1) < 1) & (labels > 0)] = label
    return labels


def change_of(made, voxel_world):
    """The largest change of the volume of a region with many voxels, per cent, and how many change by more than 2."""
    changed = [abs(v["change_pct"]) for v in made.report["regions"]["volumes_changed"]
               if v["volume_before"] > LARGE_VOXELS * voxel_world]
    return f"{max(changed):.0f}, {len(changed)}" if changed else "-"


def of_labels(given):
    row("labels, vertices", "made", "least angle between walls", "least angle of triangles", "large regions that change, %", "CPU s")
    row(*["---"] * 6)
    for name, labels, affine in given:
        voxel_world = 1 if affine is None else abs(np.linalg.det(affine[:3, :3]))
        for vertices in (1000, 2000, 6000, 20_000):
            made, seconds = measured(isoshell.Labels(labels, affine=affine), vertices=vertices)
            quality = made.report["quality"]
            row(f"{name}, {vertices}", len(made.vertices), f"{quality['dihedral_min_deg']:.1f}",
                f"{quality['theta_min_deg']:.1f}", change_of(made, voxel_world), f"{seconds:.1f}")


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


def of_gaps():
    row("a pin of radius 6 in a plate, gap", "vertices made of 6000", "area of their wall", "named", "least angle", "CPU s")
    row(*["---"] * 6)
    plate, plate_faces = prism(20, 48, hole=6)
    for gap in (0, 5e-6, 2e-5, 1e-4, 1e-3, .05):
        pin, pin_faces = prism(6 - gap, 48)
        parts = np.repeat([1, 2], [len(plate_faces), len(pin_faces)])
        mesh = isoshell.Mesh(np.concatenate([plate, pin]), np.concatenate([plate_faces, pin_faces + len(plate)]),
                             of_faces={"part": parts})
        made, seconds = measured(mesh, regions="part", vertices=6000)
        walls = {tuple(wall["labels"]): wall["area"] for wall in made.report["regions"]["walls"]}
        row(gap, len(made.vertices), f"{walls.get((1, 2), 0):.2f}",
            "yes" if any("share no wall" in text for text in made.report["warnings"]) else "no",
            f"{made.report['quality']['theta_min_deg']:.1f}", f"{seconds:.1f}")


def main():
    warnings.simplefilter("ignore")
    given = [("lesions", lesions(), None)]
    for path in sys.argv[1:]:
        arrays = np.load(path)
        given.append((pathlib.Path(path).stem, arrays["labels"], arrays.get("affine")))
    of_labels(given)
    print()
    of_random()
    print()
    of_gaps()


if __name__ == "__main__":
    main()
