#!/usr/bin/env python3
"""Watertight meshes of equal size for training: every mesh of a folder, scaled into the cube from -0.5 to 0.5.

What cannot be meshed is left out, and index.json says why. The same folder gives the same bytes on every machine.
usage: training_set.py FOLDER OUT_FOLDER [VERTICES]
"""
import json
import sys
from pathlib import Path

import numpy as np

import isoshell

FORMATS = {".obj", ".ply", ".stl", ".off", ".glb", ".gltf"}
source, target = Path(sys.argv[1]), Path(sys.argv[2])
vertices = int(sys.argv[3]) if len(sys.argv) > 3 else 4096
target.mkdir(parents=True, exist_ok=True)

index = {}
paths = sorted(p for p in source.iterdir() if p.suffix.lower() in FORMATS)
results = isoshell.remesh_many(paths, vertices=vertices, require="closed,manifold", allow_intersections=True,
                               on_error="return")
for path, result in zip(paths, results):
    if isinstance(result, isoshell.Error):
        index[path.name] = {"left_out": str(result), "code": result.code.name}
        continue
    low, high = result.vertices.min(axis=0), result.vertices.max(axis=0)
    scaled = (result.vertices - (low + high) / 2) / (high - low).max()
    np.savez_compressed(target / f"{path.name}.npz", vertices=scaled.astype(np.float32), faces=result.faces)
    index[path.name] = {"digest": result.digest, "genus": result.report["topology"]["genus"]}

(target / "index.json").write_text(json.dumps(index, indent=1) + "\n")
print(f"{sum('digest' in entry for entry in index.values())} of {len(index)} meshes")
