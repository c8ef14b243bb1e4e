#!/usr/bin/env python3
"""Blender's operator beside the command: CPU time of both on the same mesh, the least of several runs in turn.

    build/bpy/bin/python bench/blender_operator.py EXTENSION.zip VDB_ISOMESH MESH|monkey VERTICES [RUNS] [FOLDER]

MESH is an OFF or OBJ file; "monkey" is Blender's, with a subdivision modifier. The command reads what Blender exports,
with UVs where the object has them, and writes an OBJ file. FOLDER keeps the input and both results.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

import bpy
import numpy as np


def installed(archive):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.extensions.package_install_files(filepath=os.path.abspath(archive), repo="user_default",
                                             enable_on_install=True)


def load(mesh):
    if mesh == "monkey":
        bpy.ops.mesh.primitive_monkey_add()
        bpy.context.object.modifiers.new("Subdivision", "SUBSURF").levels = 2
    elif mesh.endswith(".off"):
        with open(mesh) as file:
            rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
        count = int(rows[1][0])
        data = bpy.data.meshes.new("scan")
        data.from_pydata([tuple(map(float, row[:3])) for row in rows[2:2 + count]], [],
                         [tuple(map(int, row[1:4])) for row in rows[2 + count:]])
        obj = bpy.data.objects.new("scan", data)
        bpy.context.scene.collection.objects.link(obj)
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
    else:
        bpy.ops.wm.obj_import(filepath=mesh, forward_axis="Y", up_axis="Z")
    return bpy.context.view_layer.objects.active


def export(path):
    bpy.ops.wm.obj_export(filepath=path, export_selected_objects=True, forward_axis="Y", up_axis="Z",
                          export_materials=False, export_normals=False, export_triangulated_mesh=True)


def cpu_time(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def timed(work, who):
    begun, cpu = time.perf_counter(), cpu_time(who)
    work()
    return time.perf_counter() - begun, cpu_time(who) - cpu


def main(archive, command, mesh, vertices, runs=5, folder=None):
    installed(archive)
    obj = load(mesh)
    folder = folder or tempfile.mkdtemp()
    source, target = os.path.join(folder, "source.obj"), os.path.join(folder, "command.obj")
    export(source)
    bpy.ops.ed.undo_push(message="before")
    taken = {"operator": [], "command": []}
    name = obj.name
    for _ in range(int(runs)):
        taken["command"].append(timed(lambda: subprocess.run(
            [command, source, target, "--vertices", vertices, "--uv-seams", "ignore", "--force", "--quiet",
             "--allow-intersections"], check=True),
            resource.RUSAGE_CHILDREN))
        copy = bpy.data.objects[name].copy()
        copy.data = copy.data.copy()
        bpy.context.scene.collection.objects.link(copy)
        bpy.context.view_layer.objects.active = copy
        bpy.context.view_layer.update()
        taken["operator"].append(timed(lambda: bpy.ops.object.isoshell_remesh(vertices=int(vertices), device="cpu"),
                                       resource.RUSAGE_SELF))
    for who, times in taken.items():
        wall, cpu = np.array(times).min(0)
        print(f"{who}: {wall:.2f} s, CPU {cpu:.2f} s")
    bpy.ops.object.select_all(action="DESELECT")
    copy.select_set(True)
    export(os.path.join(folder, "operator.obj"))


if __name__ == "__main__":
    main(*sys.argv[1:])
