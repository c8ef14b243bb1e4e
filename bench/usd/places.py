#!/usr/bin/env python3
"""Where readers of USD see the mesh and the volumes of a stage that `isoshell.usd.write` made.

    bench/usd/places.py STAGE...             in a Python with usd-core: extents, points, fields; what validators say
    bench/usd/places.py --blender STAGE...   in a Python with bpy: contours of the volumes as Blender makes them

Blender contours `shell_distance` at one voxel with its modifier "Volume to Mesh", and the distances of these vertices
from the mesh, both in Blender's world, are printed in voxels: they are 1 where both are at the same place.
"""
import argparse
import json

import numpy as np


def in_usd(path):
    from pxr import Usd, UsdGeom, UsdValidation, UsdVol

    stage = Usd.Stage.Open(path)
    cache = UsdGeom.XformCache()
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    found = {"validators": len(validators), "up": str(UsdGeom.GetStageUpAxis(stage)),
             "unit": UsdGeom.GetStageMetersPerUnit(stage),
             "findings": [e.GetMessage() for e in UsdValidation.ValidationContext(validators).Validate(stage)]}
    for prim in stage.Traverse():
        matrix = np.array(cache.GetLocalToWorldTransform(prim))
        if prim.IsA(UsdGeom.Mesh):
            points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]
            found["mesh"] = [points.min(0).tolist(), points.max(0).tolist()]
        elif prim.IsA(UsdVol.Volume):
            extent = np.array(UsdGeom.Boundable(prim).GetExtentAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]
            files = {name: UsdVol.OpenVDBAsset.Get(stage, field).GetFilePathAttr().Get()
                     for name, field in UsdVol.Volume(prim).GetFieldPaths().items()}
            found[prim.GetName()] = {"extent": extent.tolist(), "fields": sorted(files),
                                     "resolved": all(file.resolvedPath for file in files.values())}
    return found


def in_blender(path):
    import bpy
    from mathutils.bvhtree import BVHTree

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=path)
    shape = next(o for o in bpy.data.objects if o.type == "MESH")
    matrix = np.array(shape.matrix_world)
    points = np.array([v.co for v in shape.data.vertices], float) @ matrix[:3, :3].T + matrix[:3, 3]
    tree = BVHTree.FromPolygons(points.tolist(), [list(p.vertices) for p in shape.data.polygons])
    found = {"mesh": [points.min(0).tolist(), points.max(0).tolist()], "vertices": len(points)}
    for volume in [o for o in bpy.data.objects if o.type == "VOLUME"]:
        volume.data.grids.load()
        grid = next(g for g in volume.data.grids if g.name == "shell_distance")
        voxel = grid.matrix_object[0][0]
        contour = bpy.data.objects.new("contour", bpy.data.meshes.new("contour"))
        bpy.context.collection.objects.link(contour)
        modifier = contour.modifiers.new("contour", "VOLUME_TO_MESH")
        modifier.object, modifier.grid_name, modifier.threshold = volume, "shell_distance", voxel
        modifier.resolution_mode = "GRID"
        bpy.context.view_layer.update()
        made = contour.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        scale = np.cbrt(abs(np.linalg.det(np.array(volume.matrix_world)[:3, :3]))) * voxel
        distances = np.array([tree.find_nearest(v.co)[3] for v in made.vertices]) / scale
        found[volume.name] = {"same matrix as the mesh": bool(np.allclose(np.array(volume.matrix_world)[:3, :3],
                                                                         matrix[:3, :3], rtol=1e-6, atol=1e-12)),
                              "contour vertices": len(distances), "mean": distances.mean(),
                              "1 %": np.percentile(distances, 1), "99 %": np.percentile(distances, 99)}
        bpy.data.objects.remove(contour)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blender", action="store_true")
    parser.add_argument("stage", nargs="+")
    arguments = parser.parse_args()
    for path in arguments.stage:
        print(json.dumps({path: (in_blender if arguments.blender else in_usd)(path)}, indent=1))


if __name__ == "__main__":
    main()
