#!/usr/bin/env python3
"""Writes damaged copies of a clean OFF mesh, the same bytes every time: one file a defect.

usage: make_defects.py CLEAN.off FOLDER

  faces     10 % of the faces are missing
  holes     five balls of 5 % of the bounding box's diagonal as radius are cut out
  soup      every face has vertices of its own
  doubled   200 faces twice, 100 fins on edges, 200 T-junctions
  slivers   2000 faces split into slivers, 300 faces without area, 200 faces repeated
  noise     every vertex moved by up to half a mean edge
  two       a second, turned copy that passes through the first
  flipped   30 % of the faces turned inside out
  nan       one vertex is not a number
"""
import math
import random
import sys
from pathlib import Path


def read_off(path):
    words = iter(Path(path).read_text().split())
    assert next(words) == "OFF"
    vertices, faces, _ = int(next(words)), int(next(words)), next(words)
    points = [tuple(float(next(words)) for _ in range(3)) for _ in range(vertices)]
    triangles = []
    for _ in range(faces):
        assert next(words) == "3", "triangles only"
        triangles.append(tuple(int(next(words)) for _ in range(3)))
    return points, triangles


def write_off(path, points, triangles):
    with open(path, "w") as out:
        out.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        out.writelines("%.9g %.9g %.9g\n" % p for p in points)
        out.writelines("3 %d %d %d\n" % t for t in triangles)


def add(a, b, factor=1.0):
    return tuple(x + factor * y for x, y in zip(a, b))


def mean(points):
    return tuple(sum(c) / len(points) for c in zip(*points))


def mean_edge(points, triangles):
    return sum(math.dist(points[t[0]], points[t[1]]) for t in triangles) / len(triangles)


def normal(points, t):
    a, b, c = (points[i] for i in t)
    u, v = add(b, a, -1), add(c, a, -1)
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.hypot(*n) or 1.0
    return tuple(x / length for x in n)


def diagonal(points):
    return math.dist([min(c) for c in zip(*points)], [max(c) for c in zip(*points)])


def faces(points, triangles, rng):
    return points, [t for t in triangles if rng.random() >= 0.1]


def holes(points, triangles, rng):
    radius = 0.05 * diagonal(points)
    centres = []
    while len(centres) < 5:
        p = rng.choice(points)
        if all(math.dist(p, c) > 4 * radius for c in centres):
            centres.append(p)
    inside = [any(math.dist(p, c) < radius for c in centres) for p in points]
    return points, [t for t in triangles if not any(inside[i] for i in t)]


def soup(points, triangles, rng):
    return [points[i] for t in triangles for i in t], [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(len(triangles))]


def doubled(points, triangles, rng):
    points, triangles = list(points), list(triangles)
    edge = mean_edge(points, triangles)
    chosen = rng.sample(range(len(triangles)), 500)
    for i in chosen[:200]:
        triangles.append(triangles[i])
    for i in chosen[200:300]:
        a, b, _ = triangles[i]
        points.append(add(mean([points[a], points[b]]), normal(points, triangles[i]), 2 * edge))
        triangles.append((a, b, len(points) - 1))
    for i in chosen[300:]:  # the face on the other side of the edge keeps it whole
        a, b, c = triangles[i]
        points.append(mean([points[a], points[b]]))
        triangles[i] = (a, len(points) - 1, c)
        triangles.append((len(points) - 1, b, c))
    return points, triangles


def slivers(points, triangles, rng):
    points, triangles = list(points), list(triangles)
    chosen = rng.sample(range(len(triangles)), 2500)
    for i in chosen[:2000]:
        a, b, c = triangles[i]
        points.append(add(mean([points[a], points[b]]), add(points[c], points[a], -1), 1e-4))
        m = len(points) - 1
        triangles[i] = (a, b, m)
        triangles += [(b, c, m), (c, a, m)]
    for i in chosen[2000:2300]:
        a, b, _ = triangles[i]
        points.append(mean([points[a], points[b]]))
        triangles.append((a, len(points) - 1, b))
    for i in chosen[2300:]:
        triangles.append(triangles[i])
    return points, triangles


def noise(points, triangles, rng):
    reach = mean_edge(points, triangles) / 2
    moved = []
    for p in points:
        direction = [rng.gauss(0, 1) for _ in range(3)]
        moved.append(add(p, direction, reach * rng.random() / math.hypot(*direction)))
    return moved, triangles


def two(points, triangles, rng):
    centre = mean(points)
    shift = 0.1 * diagonal(points)
    turned = []
    for p in points:
        x, y, z = add(p, centre, -1)
        turned.append(add((z + shift, y, -x), centre))
    n = len(points)
    return list(points) + turned, list(triangles) + [(a + n, b + n, c + n) for a, b, c in triangles]


def flipped(points, triangles, rng):
    return points, [t if rng.random() >= 0.3 else (t[0], t[2], t[1]) for t in triangles]


def nan(points, triangles, rng):
    points = list(points)
    points[triangles[len(triangles) // 2][0]] = (math.nan, 0.0, 0.0)
    return points, triangles


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    points, triangles = read_off(sys.argv[1])
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for defect in (faces, holes, soup, doubled, slivers, noise, two, flipped, nan):
        write_off(folder / f"{defect.__name__}.off", *defect(points, triangles, random.Random(1)))


if __name__ == "__main__":
    main()
