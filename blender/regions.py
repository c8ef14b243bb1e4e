# SPDX-License-Identifier: Apache-2.0
"""The regions of a result: materials and attributes of one mesh, or an object each."""

import colorsys

import bpy
import numpy as np

from . import layers, mesh_result

GOLDEN = 0.6180339887498949  # of the hues of labels, so that those beside each other differ


def are_in(result):
    return len(result.regions["labels"]) > 0


def write(mesh, result):
    """Each face has the material of the region behind it, and both regions as attributes."""
    labels = result.regions["labels"]
    regions, of_face = np.unique(labels[:, 0], return_inverse=True)
    for label in regions.tolist():
        mesh.materials.append(_material(result, label))
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(of_face.reshape(-1), np.int32))
    for column, name in enumerate(("region_inside", "region_outside")):
        layers.write(mesh, layers.Layer(name, "INT", "FACE", labels[:, column]))
    _shade(mesh)


def objects_of(result, to_object):
    """An object of a closed mesh for each region; none is in a collection yet."""
    labels = np.unique(result.regions["labels"])
    objects = []
    for label in labels[labels != result.regions["background"]].tolist():
        region = result.region(label)
        mesh = bpy.data.meshes.new(_name(result, label))
        mesh_result.new_geometry(mesh, *mesh_result.in_object(region.vertices, region.faces, to_object))
        mesh.materials.append(_material(result, label))
        _shade(mesh)
        objects.append(bpy.data.objects.new(mesh.name, mesh))
    return objects


def _name(result, label):
    return result.region_names.get(label, f"Region {label}")


def _material(result, label):
    """One that has the name already is taken as it is: a second run keeps the colours that were chosen."""
    name = _name(result, label)
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    material = bpy.data.materials.new(name)
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    color = (*colorsys.hsv_to_rgb(label * GOLDEN % 1, 0.6, 0.8), 1)
    material.diffuse_color = color
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")  # names are translated
    shader.inputs["Base Color"].default_value = color
    return material


def _shade(mesh):
    """Smooth but where faces turn much, and where more than two meet."""
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.set_sharp_from_angle(angle=float(np.arccos(mesh_result.SHARP)))
