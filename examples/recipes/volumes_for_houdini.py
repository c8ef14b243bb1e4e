#!/usr/bin/env python3
"""The mesh, the shell and the Voronoi cells of a surface, as .ply and .vdb files for Houdini, Nuke and Blender.

usage: volumes_for_houdini.py MESH OUT_FOLDER [VERTICES]
"""
import sys
from pathlib import Path

import isoshell

mesh, folder = sys.argv[1], Path(sys.argv[2])
vertices = int(sys.argv[3]) if len(sys.argv) > 3 else 10_000
folder.mkdir(parents=True, exist_ok=True)

isoshell.remesh(mesh, vertices=vertices, features="off", output=folder / "mesh.ply", force=True,
                save_shell=folder / "mesh.shell.vdb", save_voronoi=folder / "mesh.voronoi.vdb")
for file in sorted(folder.iterdir()):
    print(file.name, file.stat().st_size, "bytes")
