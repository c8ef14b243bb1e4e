#!/usr/bin/env python3
"""Motion blur of a remeshed liquid: two drops that fly apart, as .vdb frames, as a stage of USD, and as pictures.

    bench/usd/motion_blur.py write FOLDER     in a Python with OpenVDB's module and numpy: FOLDER/drops.0001.vdb and so on,
                                          each with a level set `surface` and vectors `v`, world units a frame
    isoshell FOLDER/drops.####.vdb:surface FOLDER/drops.usdc --frames 1-3 --no-coherence --grids v --edge-length 0.08
    bench/usd/motion_blur.py render FOLDER    in a Python with bpy: FOLDER/blur.png and FOLDER/still.png of frame 2 by Cycles,
                                          and how wide and high each drop is in them

The left drop moves along x, the right one along y, and the shutter is open for half of a frame: blurred, each is longer by
half of its way a frame, along its way alone. Vertices of frames that are runs of their own have nothing to do with each
other, so only velocities can say where they go.
"""
import argparse
from pathlib import Path

import numpy as np

VOXEL, FRAMES, FRAME, WAY = 0.05, 3, 2, 1.2  # the way of a frame, world units
DROPS = (((-1.6, 0, 0), (WAY, 0, 0)), ((1.6, 0, 0), (0, WAY, 0)))  # where they are at frame 2, and how they move
SIZE, WIDTH = (480, 240), 6  # of the pictures in pixels, and in world units


def write(folder):
    try:
        import pyopenvdb as vdb
    except ImportError:
        import openvdb as vdb

    for frame in range(1, FRAMES + 1):
        middles = [np.add(at, np.multiply(frame - FRAME, way)) for at, way in DROPS]
        low, high = np.min(middles, axis=0) - 1, np.max(middles, axis=0) + 1
        begin = np.floor(low / VOXEL).astype(int)
        at = np.indices(np.ceil(high / VOXEL).astype(int) - begin + 1).transpose(1, 2, 3, 0)
        at = (at + begin) * VOXEL
        away = np.stack([np.linalg.norm(at - middle, axis=-1) - 0.5 for middle in middles])
        surface, v = vdb.FloatGrid(3 * VOXEL), vdb.Vec3SGrid()
        surface.copyFromArray(np.clip(away.min(axis=0), -3 * VOXEL, 3 * VOXEL), ijk=begin.tolist(), tolerance=0)
        v.copyFromArray(np.array([way for _, way in DROPS], float)[away.argmin(axis=0)], ijk=begin.tolist())
        surface.name, surface.gridClass, v.name = "surface", vdb.GridClass.LEVEL_SET, "v"
        for grid in (surface, v):
            grid.transform = vdb.createLinearTransform(VOXEL)
        vdb.write(str(folder / f"drops.{frame:04}.vdb"), [surface, v])


def render(folder):
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(folder / "drops.usdc"))
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device, scene.cycles.samples = "CYCLES", "CPU", 64
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.image_settings.color_mode, scene.view_settings.view_transform = "BW", "Standard"
    scene.world = bpy.data.worlds.new("white")
    scene.world.use_nodes = True  # before Blender 5
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    black = bpy.data.materials.new("black")
    black.use_nodes = True
    shader = black.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value, shader.inputs["Specular IOR Level"].default_value = (0, 0, 0, 1), 0
    for obj in [o for o in scene.objects if o.type == "MESH"]:
        obj.data.materials.clear()
        obj.data.materials.append(black)
    scene.camera = camera_in_front(bpy, scene)
    scene.frame_set(FRAME)
    for name, is_blurred in (("still", False), ("blur", True)):
        scene.render.use_motion_blur, scene.render.motion_blur_shutter = is_blurred, 0.5
        scene.render.filepath = str(folder / f"{name}.png")
        bpy.ops.render.render(write_still=True)
        print(name, *(f"{which}: {x:.2f} x {y:.2f}" for which, (x, y) in spreads(bpy, scene.render.filepath)))


def camera_in_front(bpy, scene):
    """The stage has y up, which is z in Blender: x is to the right of the picture, the stage's y upwards."""
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", WIDTH
    camera.location, camera.rotation_euler = (0, -10, 0), (np.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    return camera


def spreads(bpy, path):
    """How wide and how high the drops of the left and the right half of a picture are, world units."""
    image = bpy.data.images.load(path)
    width, height = image.size
    dark = np.array(image.pixels[:]).reshape(height, width, -1)[..., 0] < 0.97
    bpy.data.images.remove(image)
    for which, half in (("left", dark[:, :width // 2]), ("right", dark[:, width // 2:])):
        yield which, [WIDTH / width * np.count_nonzero(half.any(axis=axis)) for axis in (0, 1)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("write", "render"))
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    {"write": write, "render": render}[arguments.what](arguments.folder)


if __name__ == "__main__":
    main()
