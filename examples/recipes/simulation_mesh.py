#!/usr/bin/env python3
"""A surface mesh for simulation, with edges as long as a size field says and creases as edges.

The file of statistics is the certificate: smallest angle, deviation from the part, how well lengths follow the field.
usage: simulation_mesh.py PART FIELD.vdb OUT.ply STATS.json
"""
import json
import sys
from pathlib import Path

import isoshell

part, field, out, stats = sys.argv[1:]
result = isoshell.remesh(part, sizing=field, gradation=1.3, features="auto", output=out, force=True, stats=True,
                         require="closed,manifold,no-self-intersections,min-angle=15")
Path(stats).write_text(json.dumps(result.report, indent=1) + "\n")
print(f"{len(result.vertices)} vertices, smallest angle {result.report['quality']['theta_min_deg']:.1f} degrees")
