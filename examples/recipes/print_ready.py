#!/usr/bin/env python3
"""A mesh that a slicer takes, from a triangle soup: closed, manifold, without intersections and hidden walls.

usage: print_ready.py SOUP OUT.stl [VERTICES]
"""
import sys

import isoshell

soup, out = sys.argv[1:3]
vertices = int(sys.argv[3]) if len(sys.argv) > 3 else 20_000

try:
    result = isoshell.remesh(soup, vertices=vertices, outer_only=True, output=out, force=True,
                             require="closed,manifold,no-self-intersections")
except isoshell.Error as error:
    sys.exit(f"not printable: {error}")  # GATE_FAILED; or the file cannot be read, and the message says why
print(f"{out}: {len(result.faces)} triangles, genus {result.report['topology']['genus']}")
