#!/usr/bin/env python3
"""How well the edges of a mesh have the lengths of the field that tests/cli/write_sizing_fields makes on a ball: from 0.02
at the bottom to RATIO times that at the top. Independent of the program's own figure: each edge against the field at its
middle.

usage: edge_error.py MESH [--ratio R] [--free]     --free: but for one common factor, which a count of vertices implies
"""
import argparse

import numpy as np

from render import read_mesh

parser = argparse.ArgumentParser()
parser.add_argument("mesh")
parser.add_argument("--ratio", type=float, default=8)
parser.add_argument("--free", action="store_true")
arguments = parser.parse_args()

vertices, faces = read_mesh(arguments.mesh)[:2]
edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
edges = edges[edges[:, 0] < edges[:, 1]]
a, b = vertices[edges[:, 0]], vertices[edges[:, 1]]
length, height = np.linalg.norm(a - b, axis=1), (a + b)[:, 2] / 2
part = length / (0.02 * (1 + (arguments.ratio - 1) * (height + 1) / 2))
factor = part.mean() if arguments.free else 1
part = part / factor
print(f"{len(edges)} edges of {length.min():.4f} to {length.max():.4f}: |length / target - 1| is {abs(part - 1).mean():.4f}"
      f" on average, {np.percentile(abs(part - 1), 95):.3f} at 95 %; factor {factor:.4f}")
for low in np.arange(-1, 1, 0.5):
    here = (height >= low) & (height < low + 0.5)
    print(f"  z {low:+.1f} to {low + 0.5:+.1f}: {here.sum()} edges, mean of length / target {part[here].mean():.3f}")
