#!/usr/bin/env python3
"""Closed models with texture coordinates, to measure by bench/assets.py.

    bench/uv_models.py FOLDER [MESH.off ...]

- two_charts.obj: a sphere of two charts, its halves, each seen from its pole; the seam is not sharp. Each half has a
  material and a group.
- torus.obj: one chart, cut open both ways: both sides of its seams are in the same chart.
- can.ply: a cylinder whose side is one chart, cut open along a line, and whose ends are two; lists of texcoord.
- globe.obj: a sphere by length and breadth, whose texture coordinates at the poles differ from face to face.
- MESH_normals.obj: a mesh with normals of its corners, split where faces turn by more than 30 degrees.
- MESH_color.ply: a mesh with colours that are linear in position.

Needs numpy.
"""
import sys

import numpy as np


def grid(columns, rows):
    """Quads of a grid of points, (rows + 1) x columns, closed along the columns, as corner (row, column)."""
    for r in range(rows):
        for c in range(columns):
            yield [(r, c), (r, c + 1), (r + 1, c + 1), (r + 1, c)]


def write_obj(path, points, faces):
    """Faces are (lines before it, [(point, (u, v)), ...])."""
    lines, uvs, body = ["mtllib model.mtl"], {}, []
    lines += ["v %.9g %.9g %.9g" % tuple(p) for p in points]
    for before, corners in faces:
        body += before
        body.append("f " + " ".join("%d/%d" % (p + 1, uvs.setdefault("vt %.9g %.9g" % uv, len(uvs)) + 1)
                                    for p, uv in corners))
    with open(path, "w") as file:
        file.write("\n".join(lines + list(uvs) + body) + "\n")


def sphere(columns, rows):
    """Points by ring from the north pole; number(r, c) is that of a corner."""
    points = [(0, 0, 1)]
    for r in range(1, rows):
        a = np.pi * r / rows
        points += [(np.sin(a) * np.cos(2 * np.pi * c / columns), np.sin(a) * np.sin(2 * np.pi * c / columns), np.cos(a))
                   for c in range(columns)]
    points.append((0, 0, -1))

    def number(r, c):
        return 0 if r == 0 else len(points) - 1 if r == rows else 1 + (r - 1) * columns + c % columns
    return points, number


def without_repeats(corners):
    return [c for i, c in enumerate(corners) if c[0] != corners[i - 1][0]]


def two_charts(path, columns=64, rows=32):
    points, number = sphere(columns, rows)
    faces = []
    for half, name in ((0, "north"), (1, "south")):
        before = ["g half_" + name, "usemtl " + name]
        for quad in grid(columns, rows):
            if (quad[0][0] >= rows // 2) != bool(half):
                continue
            corners = []
            for r, c in quad:
                x, y, _ = points[number(r, c)]
                away = (r if half == 0 else rows - r) / (rows / 2)  # so that texels have the same size everywhere
                size = np.hypot(x, y)
                u, v = (x / size * away, y / size * away) if size > 0 else (0, 0)
                corners.append((number(r, c), (.25 + .5 * half + .24 * u, .5 + .48 * v)))
            faces.append((before, without_repeats(corners)[::-1]))
            before = []
    write_obj(path, points, [(b, c[::-1]) for b, c in orient(points, faces)])


def orient(points, faces):
    """Turns faces so that they look away from the origin, and gives them back the other way round."""
    for before, corners in faces:
        a, b, c = (np.array(points[corners[i][0]], dtype=float) for i in (0, 1, 2))
        outward = np.dot(np.cross(b - a, c - a), a + b + c) > 0
        yield before, corners[::-1] if outward else corners


def globe(path, columns=48, rows=24):
    points, number = sphere(columns, rows)
    faces = []
    for quad in grid(columns, rows):
        middle = quad[0][1] + .5
        corners = [(number(r, c), ((middle if r in (0, rows) else c) / columns, 1 - r / rows)) for r, c in quad]
        faces.append(([], without_repeats(corners)))
    write_obj(path, points, [(b, c[::-1]) for b, c in orient(points, faces)])


def torus(path, columns=96, rows=40, radius=1.0, tube=.4):
    points, faces = [], []
    for r in range(rows):
        a = 2 * np.pi * r / rows
        points += [((radius + tube * np.cos(a)) * np.cos(b), (radius + tube * np.cos(a)) * np.sin(b), tube * np.sin(a))
                   for b in 2 * np.pi * np.arange(columns) / columns]
    for quad in grid(columns, rows):
        faces.append(([], [(r % rows * columns + c % columns, (c / columns, r / rows))
                           for r, c in (quad[0], quad[1], quad[2], quad[3])]))
    write_obj(path, points, faces)


def can(path, columns=64, radius=.5, height=2.0):
    ring = [(radius * np.cos(a), radius * np.sin(a)) for a in 2 * np.pi * np.arange(columns) / columns]
    points = [(x, y, z) for z in (0, height) for x, y in ring] + [(0, 0, 0), (0, 0, height)]
    faces = []
    for c in range(columns):
        d = (c + 1) % columns
        u, w = c / columns, (c + 1) / columns
        faces.append([(c, (u, .5)), (d, (w, .5)), (columns + d, (w, 1)), (columns + c, (u, 1))])
        for end, middle in ((0, .2), (1, .7)):
            uv = [(middle + .2 * 2 * ring[k][0], .22 + .2 * 2 * ring[k][1]) for k in (c, d)]
            three = [(2 * columns + end, (middle, .22)), (end * columns + c, uv[0]), (end * columns + d, uv[1])]
            faces.append(three if end else three[::-1])
    with open(path, "w") as file:
        file.write("ply\nformat ascii 1.0\ncomment TextureFile checkers.png\nelement vertex %d\n" % len(points))
        file.write("property double x\nproperty double y\nproperty double z\nelement face %d\n" % len(faces))
        file.write("property list uchar int vertex_indices\nproperty list uchar float texcoord\n")
        file.write("property int texnumber\nend_header\n")
        for p in points:
            file.write("%.17g %.17g %.17g\n" % p)
        for corners in faces:
            uv = [x for _, pair in corners for x in pair]
            file.write(" ".join([str(len(corners))] + [str(p) for p, _ in corners] + [str(len(uv))] +
                                ["%.9g" % x for x in uv] + ["0"]) + "\n")


def read_off(path):
    with open(path) as file:
        words = file.read().split()
    count, faces = int(words[1]), int(words[2])
    points = np.array(words[4:4 + 3 * count], dtype=float).reshape(-1, 3)
    table = np.array(words[4 + 3 * count:4 + 3 * count + 4 * faces], dtype=int).reshape(-1, 4)
    return points, table[:, 1:]


def with_normals(path, points, faces, degrees=30):
    """A corner's normal is the mean of those of its vertex's faces that turn from its own by less than the angle."""
    area = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    unit = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-300)
    around = [[] for _ in points]
    for f, t in enumerate(faces):
        for v in t:
            around[v].append(f)
    lines, normals = [], {}
    for f, t in enumerate(faces):
        names = []
        for v in t:
            beside = [g for g in around[v] if unit[g] @ unit[f] > np.cos(np.radians(degrees))]
            n = area[sorted(beside)].sum(axis=0) if beside else unit[f]
            n = n / max(np.linalg.norm(n), 1e-300)
            names.append("%d//%d" % (v + 1, normals.setdefault("vn %.6f %.6f %.6f" % tuple(n), len(normals)) + 1))
        lines.append("f " + " ".join(names))
    with open(path, "w") as file:
        file.write("\n".join(["v %.17g %.17g %.17g" % tuple(p) for p in points] + list(normals) + lines) + "\n")


def with_color(path, points, faces):
    lo, hi = points.min(axis=0), points.max(axis=0)
    with open(path, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
        file.write("".join("property %s\n" % p for p in ("double x", "double y", "double z", "float red", "float green",
                                                         "float blue")))
        file.write("element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces))
        for p in points:
            file.write("%.17g %.17g %.17g %.9g %.9g %.9g\n" % (tuple(p) + tuple((p - lo) / (hi - lo))))
        for t in faces:
            file.write("3 %d %d %d\n" % tuple(t))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder = sys.argv[1]
    for path in sys.argv[2:]:
        name = folder + "/" + path.split("/")[-1][:-len(".off")]
        with_normals(name + "_normals.obj", *read_off(path))
        with_color(name + "_color.ply", *read_off(path))
    two_charts(folder + "/two_charts.obj")
    globe(folder + "/globe.obj")
    torus(folder + "/torus.obj")
    can(folder + "/can.ply")


if __name__ == "__main__":
    main()
