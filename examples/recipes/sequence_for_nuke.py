#!/usr/bin/env python3
"""Frames of a cache as one stage of USD: a mesh with time samples and velocities, for Nuke and Houdini.

usage: sequence_for_nuke.py 'cache.####.obj' FIRST-LAST OUT.usdc [VERTICES]
"""
import sys

import isoshell
from pxr import Usd, UsdGeom

cache, frames, path = sys.argv[1:4]
vertices = int(sys.argv[4]) if len(sys.argv) > 4 else 10_000

for result in isoshell.remesh_sequence(cache, frames=frames, output=path, vertices=vertices, force=True):
    kept = (result.report["coherence"] or {}).get("kept_edges_pct")
    print("frame", result.frame, "" if kept is None else f"keeps {kept:.1f} % of the edges")
stage = Usd.Stage.Open(path)
for prim in stage.Traverse():
    if prim.IsA(UsdGeom.Mesh):
        print(prim.GetPath(), "has points at", UsdGeom.Mesh(prim).GetPointsAttr().GetTimeSamples())
