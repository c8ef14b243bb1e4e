# SPDX-License-Identifier: Apache-2.0
"""A result of isoshell as the mesh of an object."""

import numpy as np

from . import layers
from .mesh_source import SET_OF_UV, SOURCE_FACE, turned

SHARP = np.cos(np.radians(30))  # where curves of a smooth result turn by more, its normals part


def new_geometry(mesh, vertices, faces):
    """The mesh with these triangles and nothing else."""
    mesh.clear_geometry()
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).reshape(-1))
    mesh.loops.add(faces.size)
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(faces, np.int32).reshape(-1))
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, faces.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)


def write_values(mesh, values, grids):
    """What vertices have of grids, of each as one attribute with its name."""
    for grid in grids:
        names = grid["attributes"]
        if not all(name in values for name in names):
            continue  # a mesh of regions that was made twice
        rows = np.column_stack([values[name] for name in names])
        if names == ["color"]:
            kind, rows = "FLOAT_COLOR", np.column_stack([rows, np.ones(len(rows))])
        elif rows.shape[1] == 3:
            kind = "FLOAT_VECTOR"
        else:
            kind = "INT" if rows.dtype.kind in "iu" else "FLOAT"
        name = f"{grid['name']}_" if grid["name"] in layers.OF_BLENDER else grid["name"]
        layers.write(mesh, layers.Layer(name, kind, "POINT", rows))


def in_object(vertices, faces, to_object):
    """Vertices in the space of an object, and faces, which look outward there."""
    return vertices @ to_object, turned(faces, np.linalg.det(to_object) < 0)


def put(obj, taken, result, apply_modifiers):
    """Gives the object the result; its data becomes its own where others share it. Returns notes for the user."""
    notes = list(taken.notes)
    if obj.data.users > 1:
        notes.append(f"the result is {obj.name}'s own mesh; other objects keep theirs")
        obj.data = obj.data.copy()
    if obj.data.shape_keys:
        obj.shape_key_clear()
        notes.append("shape keys ended in the shape that they had")
    groups = [(group.name, group.lock_weight) for group in obj.vertex_groups]
    active_group = obj.vertex_groups.active_index
    chosen = _chosen_layers(obj.data)
    _fill(obj.data, taken, result)
    _choose_layers(obj.data, chosen)
    _write_groups(obj, groups, active_group, result.attributes)
    if apply_modifiers:
        for modifier in [m for m in obj.modifiers if m.show_viewport]:
            obj.modifiers.remove(modifier)
    obj.data.update()
    return notes


def _fill(mesh, taken, result):
    mirrored, values = taken.is_mirrored, result.attributes
    faces = turned(result.faces, mirrored)
    new_geometry(mesh, result.vertices @ np.linalg.inv(taken.to_world).T, faces)
    source_face = values[SOURCE_FACE].astype(np.int64)
    material = values["material"] if "material" in values else taken.material[source_face]
    smooth = taken.smooth[source_face]
    if [m for m in mesh.materials] != taken.materials and taken.materials:  # modifiers may set them
        mesh.materials.clear()
        for m in taken.materials:
            mesh.materials.append(m)
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(material, np.int32))
    mesh.polygons.foreach_set("use_smooth", smooth)
    if smooth.any():
        _mark_sharp_edges(mesh, result)
    for name, uv in zip(taken.uv_names, SET_OF_UV):
        rows = turned(values[uv], mirrored)
        mesh.uv_layers.new(name=name, do_init=False).uv.foreach_set("vector", np.ascontiguousarray(rows, np.float32)
                                                                    .reshape(-1))
    for layer, names in taken.point_layers:
        rows = np.stack([values[name] for name in names], axis=1)
        layers.write(mesh, layers.Layer(layer.name, layer.kind, "POINT", rows))
    for layer in taken.face_layers:
        layers.write(mesh, layers.Layer(layer.name, layer.kind, "FACE", layer.rows[source_face]))


def _mark_sharp_edges(mesh, result):
    """Creases of the result: its curves where faces turn much. Seams of texture coordinates are curves, too."""
    curves = np.sort(result.features["curve_edges"], axis=1).astype(np.int64)
    if not curves.size:
        return
    width = len(result.vertices)
    directed = result.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    keys = np.sort(directed, axis=1) @ (width, 1)
    order = np.argsort(keys, kind="stable")
    a, b, c = (result.vertices[result.faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    face = np.repeat(np.arange(len(normal)), 3)[order]
    first = np.flatnonzero(keys[order][:-1] == keys[order][1:])
    turns = np.einsum("nj,nj->n", normal[face[first]], normal[face[first + 1]]) < SHARP
    sharp = np.intersect1d(keys[order][first[turns]], curves @ (width, 1))
    edges = np.sort(layers.read(mesh.edges, "vertices", (len(mesh.edges), 2), np.int32), axis=1).astype(np.int64)
    mesh.edges.foreach_set("use_edge_sharp", np.isin(edges @ (width, 1), sharp))


def _write_groups(obj, groups, active, values):
    obj.vertex_groups.clear()
    for i, (name, locked) in enumerate(groups):
        group = obj.vertex_groups.new(name=name)
        layers.write_group(group, values[f"blender_group_{i}"])
        group.lock_weight = locked
    if groups:
        obj.vertex_groups.active_index = active


def _chosen_layers(mesh):
    uv = mesh.uv_layers
    return (uv.active.name if uv.active else "", next((layer.name for layer in uv if layer.active_render), ""),
            mesh.color_attributes.active_color_name, mesh.color_attributes.default_color_name)


def _choose_layers(mesh, chosen):
    active_uv, render_uv, active_color, default_color = chosen
    if active_uv in mesh.uv_layers:
        mesh.uv_layers.active = mesh.uv_layers[active_uv]
    if render_uv in mesh.uv_layers:
        mesh.uv_layers[render_uv].active_render = True
    if active_color in mesh.color_attributes:
        mesh.color_attributes.active_color_name = active_color
    if default_color in mesh.color_attributes:
        mesh.color_attributes.default_color_name = default_color
