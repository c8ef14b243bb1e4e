#!/usr/bin/env python3
"""Meshes whose parts share walls or touch, by formula: what becomes of them, as a Markdown table.

usage: assemblies.py [--vertices 4000] [--only NAME...] [--keep FOLDER]

Writes each as an OBJ file with a group a part, and meshes it with `regions="groups"`. Corners: how far the corners that
the walls have, those where parts touch as well, are from the nearest vertex. Planes: how far vertices of flat walls are
from these. Both in the units of the input.
"""
import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(low, high):
    """Vertices and triangles that face outward."""
    vertices = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    return vertices, [t for a, b, c, d in SIDES for t in ((a, b, c), (a, c, d))]


def prism(sides, radius, low, high):
    """A cylinder of so many flat sides around the z axis."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    vertices = [(*p, z) for z in (low, high) for p in ring.tolist()] + [(0, 0, low), (0, 0, high)]
    triangles = []
    for i in range(sides):
        j = (i + 1) % sides
        triangles += [(i, j, sides + j), (i, sides + j, sides + i), (2 * sides, j, i), (2 * sides + 1, sides + i, sides + j)]
    return vertices, triangles


def sheet(corner, along, across):
    """A rectangle."""
    o, a, b = (np.array(x, float) for x in (corner, along, across))
    return [tuple(p) for p in (o, o + a, o + a + b, o + b)], [(0, 1, 2), (0, 2, 3)]


PLATE, PIN, NUT = box((-2, -2, 0), (2, 2, 0.5)), prism(40, 0.7, -1, 1.5), prism(6, 1.1, 0.5, 0.9)
ASSEMBLIES = {
    "touching cubes": {"left": box((0, 0, 0), (1, 1, 1)), "right": box((1, 0, 0), (2, 1, 1))},
    "touching cubes of different sizes": {"left": box((0, 0, 0), (1, 1, 1)), "right": box((1, 0.2, 0.1), (1.7, 0.9, 1.3))},
    "T of three sheets": {"left": sheet((0, 0, 0), (-1, 0, 0), (0, 1, 0)), "right": sheet((0, 0, 0), (1, 0, 0), (0, 1, 0)),
                          "up": sheet((0, 0, 0), (0, 0, 1), (0, 1, 0))},
    "sheet inside of a cube": {"cube": box((0, 0, 0), (1, 1, 1)), "sheet": sheet((0.2, 0.2, 0.5), (0.6, 0, 0), (0, 0.6, 0))},
    "cylinder through a plate": {"plate": PLATE, "pin": PIN},
    "the same with a nut": {"plate": PLATE, "pin": PIN, "nut": NUT},
}


def write_obj(path, parts):
    start, lines = 1, []
    for name, (vertices, triangles) in parts.items():
        lines.append(f"g {name}")
        lines += ["v {!r} {!r} {!r}".format(*map(float, p)) for p in vertices]
        lines += ["f {} {} {}".format(*(i + start for i in t)) for t in triangles]
        start += len(vertices)
    path.write_text("\n".join(lines) + "\n")


def corners_of(parts):
    """Of boxes, sheets and prisms, without the middles of a prism's ends."""
    return np.array([p for vertices, _ in parts.values() for p in vertices if np.hypot(p[0], p[1]) > 0 or len(vertices) < 12])


def off_planes(parts, vertices):
    """The largest distance of a vertex from the nearest plane of all input triangles."""
    planes = []
    for points, triangles in parts.values():
        p = np.array(points, float)[np.array(triangles)]
        n = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        planes += [np.append(a, a @ b) for a, b in zip(n, p[:, 0])]
    planes = np.unique(np.round(planes, 12), axis=0)
    return np.abs(vertices @ planes[:, :3].T - planes[:, 3]).min(axis=1).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--vertices", type=int, default=4000)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--keep", type=Path, help="folder for the inputs and the results")
    given = parser.parse_args()
    import isoshell
    folder = given.keep or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    print("| input | seconds | regions | closed | vertices | Q | least angle | crossings | corners | planes |")
    print("| --- " * 10 + "|")
    for name, parts in ASSEMBLIES.items():
        if given.only and name not in given.only:
            continue
        path = folder / (name.replace(" ", "-") + ".obj")
        write_obj(path, parts)
        start = time.perf_counter()
        made = isoshell.remesh(path, output=path.with_suffix(".ply"), vertices=given.vertices, regions="groups", force=True)
        seconds = time.perf_counter() - start
        vertices, report, quality = np.asarray(made.vertices), made.report["regions"], made.report["quality"]
        far = np.sqrt(((corners_of(parts)[:, None] - vertices[None]) ** 2).sum(axis=2)).min(axis=1).max()
        print(f"| {name} | {seconds:.1f} | {len(report['regions'])} | {report['every_region_closed']} | {len(vertices)} | "
              f"{quality['q_avg']:.3f} | {quality['theta_min_deg']:.1f} | {report['self_intersecting_pairs']} | "
              f"{far:.1e} | {off_planes(parts, vertices):.1e} |", flush=True)


if __name__ == "__main__":
    main()
