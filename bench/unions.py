#!/usr/bin/env python3
"""Unites the components of files, by isoshell and by manifold3d in the same run, one thread each.

    python3 bench/unions.py BUILD MESH...

BUILD is a folder with bench_unions. Needs manifold3d, numpy and trimesh. manifold3d gets each component alone, turned
outward, and joins all in one batch; what it calls not manifold is left out, and counted. Times are CPU seconds, the
least of five runs of each.
"""
import json
import pathlib
import subprocess
import sys
import time

import manifold3d
import numpy
import trimesh


def solids_of(path):
    mesh = trimesh.load(path, force="mesh", process=True)
    mesh.merge_vertices(merge_norm=True, merge_tex=True)
    solids, left_out = [], 0
    for part in mesh.split(only_watertight=False):
        if part.volume < 0:
            part.invert()
        solid = manifold3d.Manifold(manifold3d.Mesh64(numpy.asarray(part.vertices, numpy.float64),
                                                      numpy.asarray(part.faces, numpy.uint64)))
        if solid.status() == manifold3d.Error.NoError:
            solids.append(solid)
        else:
            left_out += 1
    return solids, left_out


def main():
    build, paths = pathlib.Path(sys.argv[1]), sys.argv[2:]
    print("| input | faces | isoshell CPU s | faces | volume | genus | manifold3d CPU s | faces | volume | genus | left out | ratio |")
    print("|---|" + "---|" * 11)
    for path in paths:
        ours = json.loads(subprocess.run([build / "bench_unions", path], check=True, capture_output=True).stdout)
        seconds = []
        for _ in range(5):
            solids, left_out = solids_of(path)  # it keeps what it has computed of them
            begin = time.process_time()
            united = manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add)
            faces, volume, genus = united.num_tri(), united.volume(), united.genus()
            seconds.append(time.process_time() - begin)
        print(f"| {pathlib.Path(path).stem} | {ours['faces_before']} | {ours['cpu_seconds']:.4f} | {ours['faces']} "
              f"| {ours['volume']:.6g}{' ' + ours['given_up'] if ours['given_up'] else ''} | {ours['genus']} "
              f"| {min(seconds):.4f} | {faces} | {volume:.6g} | {genus} | {left_out} | {ours['cpu_seconds'] / min(seconds):.2f} |", flush=True)


if __name__ == "__main__":
    main()
