#!/usr/bin/env python3
"""A size field: edges of length FINE around a point, growing with the distance from it up to COARSE.

Needs OpenVDB's Python module only, such as python3-openvdb of Debian, with the system's own Python.
usage: size_field.py OUT.vdb X Y Z RADIUS FINE COARSE
"""
import sys
from math import ceil, dist

try:
    import pyopenvdb as vdb
except ImportError:
    import openvdb as vdb

out = sys.argv[1]
x, y, z, radius, fine, coarse = map(float, sys.argv[2:])

voxel = radius / 8  # the field varies slowly: eight voxels are enough
grid = vdb.FloatGrid(background=coarse)
grid.name = "edge_length"
grid.transform = vdb.createLinearTransform(voxel)
values = grid.getAccessor()
near, far = ([int(c / voxel) + side * ceil(radius / voxel) for c in (x, y, z)] for side in (-1, 1))
for i in range(near[0], far[0] + 1):
    for j in range(near[1], far[1] + 1):
        for k in range(near[2], far[2] + 1):
            part = min(1.0, dist((i * voxel, j * voxel, k * voxel), (x, y, z)) / radius)
            values.setValueOn((i, j, k), fine + (coarse - fine) * part)
vdb.write(out, grids=[grid])
