#!/usr/bin/env python3
"""Writes assemblies and shells that are hard for a remesher, as closed meshes, the same each time.

    hard_shapes.py FOLDER

chain.obj: 100 linked rings of 24 x 18 squares, 86,400 triangles. hair.obj: 3200 closed curved strands that grow
out of a ball, 65,280 triangles. wing.obj: a swept, tapered NACA 2412 wing, 4,876 triangles, whose trailing edge is .001
of the chord thick. Needs numpy.
"""
import argparse
import pathlib

import numpy as np


def tube(rings, count, wraps=False):
    """Triangles of rings of count points each, one behind another, which face outward where the rings turn to the left
    around where they go; the ends are fans around their first points, or joined."""
    faces = []
    for i in range(rings - (not wraps)):
        a, b = i * count, (i + 1) % rings * count
        for j in range(count):
            k = (j + 1) % count
            faces += [(a + j, a + k, b + k), (a + j, b + k, b + j)]
    if not wraps:
        last = (rings - 1) * count
        for j in range(1, count - 1):
            faces += [(0, j + 1, j), (last, last + j, last + j + 1)]
    return np.array(faces)


def ring(around, through, radius, thick):
    """A torus around the z axis."""
    u = np.arange(around) * 2 * np.pi / around
    v = np.arange(through) * 2 * np.pi / through
    u, v = np.meshgrid(u, v, indexing="ij")
    away = radius + thick * np.cos(v)
    points = np.stack([away * np.cos(u), away * np.sin(u), thick * np.sin(v)], -1)
    return points.reshape(-1, 3), tube(around, through, True)


def chain(links=100, step=1.4):
    """Links along x, every other one turned by a right angle about x."""
    parts = []
    for i in range(links):
        points, faces = ring(24, 18, 1.0, 0.22)
        faces = faces[:, ::-1]  # u goes around z and v up, outward is v x u
        if i % 2:
            points = points[:, [0, 2, 1]] * (1, -1, 1)
        parts.append((points + (step * i, 0, 0), faces))
    return parts


def ball(radius, rings=20, around=32):
    """1,280 triangles."""
    tilt = np.linspace(0, np.pi, rings + 2)[1:-1, None]
    turn = np.arange(around)[None] * 2 * np.pi / around
    points = np.stack(np.broadcast_arrays(np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), -np.cos(tilt)), -1)
    sides, count = tube(rings, around)[:(rings - 1) * 2 * around], rings * around
    ends = [f for j in range(around) for f in ((count, (j + 1) % around, j),
                                               (count + 1, count - around + j, count - around + (j + 1) % around))]
    poles = [(0, 0, -radius), (0, 0, radius)]
    return np.concatenate([radius * points.reshape(-1, 3), poles]), np.concatenate([sides, ends])


def hair(strands=3200, rings=3, count=4, seed=7):
    """Curved tubes of square section, of 20 triangles each, that begin .02 below the skin of a ball."""
    random = np.random.default_rng(seed)
    parts = [ball(1.02)]
    for i in range(strands):
        z = 1 - 2 * (i + 0.5) / strands  # evenly on a ball, turned by the golden angle
        turn = i * np.pi * (3 - 5 ** 0.5)
        root = np.array([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z])
        side = np.cross(root, random.normal(size=3))
        side /= np.linalg.norm(side)
        across = np.cross(root, side)
        t = np.linspace(0, 1, rings)[:, None]
        middle = root * (1 + 0.5 * t) + 0.25 * t ** 2 * side * random.uniform(0.4, 1)
        radius = 0.006 * (1 - 0.5 * t)
        angle = np.arange(count) * 2 * np.pi / count
        points = (middle[:, None] + radius[:, None] * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * across))
        parts.append((points.reshape(-1, 3), tube(rings, count)))
    return parts


def airfoil(count, thickness=0.12, camber=0.02, peak=0.4, trailing=0.001):
    """NACA 4 digits: from the upper end of the trailing edge along the nose to the lower one."""
    x = (1 - np.cos(np.linspace(0, np.pi, count))) / 2
    naca = 0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    half = 5 * thickness * naca + trailing / 2 * x
    line = np.where(x < peak, camber / peak**2 * (2 * peak * x - x**2),
                    camber / (1 - peak)**2 * (1 - 2 * peak + 2 * peak * x - x**2))
    upper, lower = np.stack([x, line + half], 1), np.stack([x, line - half], 1)
    return np.concatenate([upper[::-1], lower[1:]])


def wing(stations=40, count=31, span=4.0, sweep=0.5, taper=0.5):
    """Tapered and swept back, along y, with flat ends."""
    profile = airfoil(count)
    points = []
    for t in np.linspace(0, 1, stations):
        chord = 1 - (1 - taper) * t
        x, z = chord * profile.T
        points.append(np.stack([sweep * span * t + x, np.full(len(profile), span * t), z], 1))
    return [(np.concatenate(points), end_strips(tube(stations, len(profile)), stations, len(profile))[:, ::-1])]


def end_strips(faces, rings, count):
    """Ends as strips between the upper and the lower side instead of fans."""
    sides, last, strip = faces[:(rings - 1) * 2 * count], (rings - 1) * count, []
    i, j = 0, count - 1
    while j - i > 1:
        strip.append((i, i + 1, j))
        i += 1
        if j - i > 1:
            strip.append((i, j - 1, j))
            j -= 1
    strip = np.array(strip)
    return np.concatenate([sides, strip[:, ::-1], strip + last])


def write(path, parts):
    with open(path, "w") as file:
        start = 1
        for points, faces in parts:
            file.writelines("v %.9g %.9g %.9g\n" % tuple(p) for p in points)
            file.writelines("f %d %d %d\n" % tuple(f) for f in faces + start)
            start += len(points)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, parts in {"chain": chain(), "hair": hair(), "wing": wing()}.items():
        write(folder / f"{name}.obj", parts)
