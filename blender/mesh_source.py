# SPDX-License-Identifier: Apache-2.0
"""An object of Blender as what isoshell starts from."""

from dataclasses import dataclass, field

import numpy as np

from . import layers

SOURCE_FACE = "blender_face"  # of result's faces: the face of the source that lies under their middle
SET_OF_UV = ("uv", "uv1", "uv2", "uv3", "uv4", "uv5", "uv6", "uv7")


class Refused(Exception):
    """The object cannot be remeshed; the message says why, and what to do."""


@dataclass
class Taken:
    """A mesh in world scale, and all that goes back to the object with the result."""

    mesh: object                 # isoshell.Mesh
    to_world: np.ndarray         # (3, 3), of the object without its place
    corners: np.ndarray          # (M, 3) vertices of the triangles as Blender has them
    weights: np.ndarray          # (groups, vertices)
    face_layers: list
    point_layers: list           # (layer, its names as numbers of the mesh)
    uv_names: list
    smooth: np.ndarray           # of the faces
    material: np.ndarray         # of the faces
    materials: list
    notes: list = field(default_factory=list)

    @property
    def is_mirrored(self):
        return np.linalg.det(self.to_world) < 0

    @property
    def world_vertices(self):
        return self.mesh.vertices


def linear_of(obj):
    """The object's transform without its place; what the result is scaled back by."""
    linear = np.array(obj.matrix_world.to_3x3(), np.float64)
    scales = np.linalg.svd(linear, compute_uv=False)
    if not np.isfinite(linear).all() or scales[-1] <= 1e-9 * max(scales[0], 1e-30):
        raise Refused(f"{obj.name} is flat: its scale along an axis is 0; give it a scale above 0")
    return linear


def turned(rows, is_mirrored):
    """Corners of faces the other way round where the object is a mirror image: its faces look inward in the world."""
    return np.ascontiguousarray(rows[:, ::-1]) if is_mirrored else rows


def take(obj, depsgraph, apply_modifiers):
    """The object's mesh with what it carries. Raises Refused."""
    linear = linear_of(obj)
    owner = obj.evaluated_get(depsgraph) if apply_modifiers else obj
    mesh = owner.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph) if apply_modifiers else obj.data
    try:
        if not mesh.polygons:
            raise Refused(f"{obj.name} has no faces; there is nothing to remesh")
        return _taken(obj, mesh, linear)
    finally:
        if apply_modifiers:
            owner.to_mesh_clear()


def _taken(obj, mesh, linear):
    import isoshell

    mesh.calc_loop_triangles()
    count = len(mesh.loop_triangles)
    corners = layers.read(mesh.loop_triangles, "vertices", (count, 3), np.int32)
    loops = layers.read(mesh.loop_triangles, "loops", (count, 3), np.int32)
    polygon = layers.read(mesh.loop_triangles, "polygon_index", count, np.int32)
    positions = layers.read(mesh.vertices, "co", (len(mesh.vertices), 3)).astype(np.float64) @ linear.T
    material = layers.read(mesh.polygons, "material_index", len(mesh.polygons), np.int32)
    smooth = layers.read(mesh.polygons, "use_smooth", len(mesh.polygons), bool)
    is_mirrored = np.linalg.det(linear) < 0

    notes = []
    point_layers, face_layers = _sorted_layers(mesh, notes)
    of_vertices, named_layers = {}, []
    for layer in point_layers:
        names = [f"blender_{len(of_vertices) + i}" for i in range(layer.rows.shape[1])]
        named_layers.append((layer, names))
        of_vertices.update(zip(names, layer.rows.T.astype(np.float32)))
    weights = layers.group_weights(mesh, len(obj.vertex_groups))
    of_vertices.update((f"blender_group_{i}", row) for i, row in enumerate(weights))

    uvs = layers.uv_layers(mesh)
    of_corners = {name: turned(rows[loops], is_mirrored) for name, (_, rows) in zip(SET_OF_UV, uvs)}
    of_faces, labels = {SOURCE_FACE: polygon}, {}
    if (material != material[0]).any():  # the result has edges where materials meet
        of_faces["material"] = material[polygon]
        labels["material"] = [str(i) for i in range(int(material.max()) + 1)]
    source = isoshell.Mesh(positions, turned(corners, is_mirrored), of_vertices=of_vertices, of_faces=of_faces,
                           of_corners=of_corners, labels=labels)
    return Taken(source, linear, corners, weights, face_layers, named_layers,
                 [name for name, _ in uvs[:len(SET_OF_UV)]], smooth, material,
                 [m.original if m else None for m in mesh.materials], notes)


def _sorted_layers(mesh, notes):
    """Layers of vertices, to interpolate, and of faces, to look up; corners are averaged at their vertex."""
    taken, left_out = layers.layers_of(mesh)
    loop_vertices = layers.read(mesh.loops, "vertex_index", len(mesh.loops), np.int32)
    points = [layer for layer in taken if layer.domain == "POINT"]
    for layer in taken:
        if layer.domain == "CORNER":
            averaged, differ = layers.at_vertices(layer, loop_vertices, len(mesh.vertices))
            points.append(averaged)
            if differ:
                notes.append(f"{layer.name} jumps between faces, and is averaged where it does")
    if left_out:
        names = ", ".join(left_out)
        notes.append(f"without {names}: attributes of edges, or of a type that cannot be interpolated")
    return points, [layer for layer in taken if layer.domain == "FACE"]
