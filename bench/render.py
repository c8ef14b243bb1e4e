#!/usr/bin/env python3
"""Renders a triangle mesh (PLY binary little-endian, OBJ, OFF) to a PNG: flat shading, edges drawn, orthographic.
Faces of a PLY have their colours, and the edges of its element edge are drawn bold.

usage: render.py MESH OUT.png [--size N] [--view X,Y,Z] [--up X,Y,Z] [--zoom F] [--no-edges]
Needs numpy only.
"""
import argparse
import struct
import zlib

import numpy as np


def read_mesh(path):
    data = open(path, "rb").read()
    if path.endswith(".ply"):
        head, body = data.split(b"end_header\n", 1)
        types = {"float": "<f4", "double": "<f8", "uchar": "u1", "uint": "<u4", "int": "<i4"}
        tables, rows = {}, []
        for words in (l.split() for l in head.decode().split("\n")):
            if words[:1] == ["element"]:
                rows.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                length = {"texcoord": 6, "normals": 9}.get(words[4], 3)  # of a triangle
                name = "corner" if length == 3 else words[4]
                rows[-1][2].extend([("count of " + name, "u1"), (name, types[words[3]], length)])
            elif words[:1] == ["property"]:
                rows[-1][2].append((words[2], types[words[1]]))
        at = 0
        for name, count, row in rows:
            tables[name] = np.frombuffer(body, np.dtype(row), count, at)
            at += tables[name].nbytes
        columns = lambda name, parts: np.stack([tables[name][c] for c in parts], axis=1).astype(float)
        faces = tables["face"]
        colours = columns("face", ("red", "green", "blue")) if "red" in faces.dtype.names else None
        curves = set()
        if "edge" in tables:
            curves = {(min(e), max(e)) for e in columns("edge", ("vertex1", "vertex2")).astype(int).tolist()}
        return columns("vertex", "xyz"), faces["corner"].astype(int), colours, curves
    text = data.decode().split("\n")
    if path.endswith(".off"):
        tokens = [t for l in text if not l.startswith("#") for t in l.split()][1:]
        nv, nf = int(tokens[0]), int(tokens[1])
        v = np.array(tokens[3:3 + 3 * nv], float).reshape(nv, 3)
        return v, np.array(tokens[3 + 3 * nv:3 + 3 * nv + 4 * nf], int).reshape(nf, 4)[:, 1:], None, set()
    v = [l.split()[1:4] for l in text if l.startswith("v ")]
    f = [[int(w.split("/")[0]) - 1 for w in l.split()[1:4]] for l in text if l.startswith("f ")]
    return np.array(v, float), np.array(f), None, set()


def write_png(path, image):
    rows = b"".join(b"\0" + row.tobytes() for row in image)
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    h, w, _ = image.shape
    open(path, "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, 8, 2, 0, 0, 0))
                           + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def render(v, f, colours, curves, size, view, up, zoom, edges, framed=None):
    """The picture; frames of a film are `framed` by the same points. All edges are drawn, or those of a set of pairs."""
    back = view / np.linalg.norm(view)
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back])
    p = v @ axes.T
    shown = p if framed is None else framed @ axes.T
    centre, extent = (shown.max(0) + shown.min(0)) / 2, np.ptp(shown, axis=0)[:2].max()
    p = (p - centre) * (0.94 * size * zoom / extent)
    p[:, 0] += size / 2
    p[:, 1] = size / 2 - p[:, 1]
    image = np.full((size, size, 3), 255, np.uint8)
    depth = np.full((size, size), -1e30)
    light = np.array([0.35, 0.45, 0.82])
    for number, t in enumerate(f):
        a, b, c = p[t]
        n = np.cross(*((v[t[1:]] - v[t[0]]) @ axes.T))
        if not np.linalg.norm(n):
            continue
        n /= np.linalg.norm(n)
        x0, y0 = np.floor(np.minimum(np.minimum(a, b), c)[:2]).astype(int).clip(0, size - 1)
        x1, y1 = np.ceil(np.maximum(np.maximum(a, b), c)[:2]).astype(int).clip(0, size - 1)
        det = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if x1 < x0 or y1 < y0 or det == 0:
            continue
        ys, xs = np.mgrid[y0:y1 + 1, x0:x1 + 1]
        px, py = xs + 0.5 - a[0], ys + 0.5 - a[1]
        w1 = (px * (c[1] - a[1]) - py * (c[0] - a[0])) / det
        w2 = (py * (b[0] - a[0]) - px * (b[1] - a[1])) / det
        w0 = 1 - w1 - w2
        z = w0 * a[2] + w1 * b[2] + w2 * c[2]
        hit = (w0 >= 0) & (w1 >= 0) & (w2 >= 0) & (z > depth[y0:y1 + 1, x0:x1 + 1])
        if not hit.any():
            continue
        front = np.array([205, 216, 232]) if n[2] > 0 else np.array([232, 120, 110])
        if colours is not None and n[2] > 0:
            front = colours[number]
        colour = np.where(True, front * (0.35 + 0.65 * abs(n @ light)), 0)
        block = np.broadcast_to(colour, hit.shape + (3,)).copy()
        if edges:
            height = abs(det) / np.array([np.hypot(*(c - b)[:2]), np.hypot(*(a - c)[:2]), np.hypot(*(b - a)[:2])]).clip(1e-9)
            away = [w * h for w, h in zip((w0, w1, w2), height)]  # from the side opposite of each corner
            sides = [tuple(sorted((int(t[(i + 1) % 3]), int(t[(i + 2) % 3])))) for i in range(3)]
            drawn = [away[i] for i in range(3) if edges is True or sides[i] in edges]
            near = np.min(drawn, axis=0) if drawn else np.full(hit.shape, np.inf)
            block = np.where((near < 0.6)[..., None], block * 0.35, block)
            for i in range(3):
                if sides[i] in curves:
                    block = np.where((away[i] < 2)[..., None], 0, block)
        image[y0:y1 + 1, x0:x1 + 1][hit] = block[hit].clip(0, 255).astype(np.uint8)
        depth[y0:y1 + 1, x0:x1 + 1][hit] = z[hit]
    return image


def main():
    args = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    args.add_argument("mesh")
    args.add_argument("png")
    args.add_argument("--size", type=int, default=1200)
    args.add_argument("--view", default="0.3,0.2,1")
    args.add_argument("--up", default="0,1,0")
    args.add_argument("--zoom", type=float, default=1)
    args.add_argument("--no-edges", action="store_true")
    a = args.parse_args()
    vector = lambda s: np.array([float(x) for x in s.split(",")])
    v, f, colours, curves = read_mesh(a.mesh)
    write_png(a.png, render(v, f, colours, curves, a.size, vector(a.view), vector(a.up), a.zoom, not a.no_edges))


if __name__ == "__main__":
    main()
