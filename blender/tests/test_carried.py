"""What a mesh has beside its shape, on a scene whose every value is known at every place."""

import bpy
import numpy as np
import pytest
from conftest import edge_lengths, rows, triangles_of


def tinted(position):
    return np.column_stack([0.5 + position / 4, np.ones(len(position))])


@pytest.fixture
def box():
    """A cube of edge 2 with UVs, a second set of them, two materials, a colour, a vertex group and numbers of faces,
    below a modifier that subdivides it."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    obj = bpy.context.object
    mesh = obj.data
    for name in ("red", "blue"):
        mesh.materials.append(bpy.data.materials.new(name))
    mesh.polygons.foreach_set("material_index", [0, 0, 0, 0, 1, 1])
    second = mesh.uv_layers.new(name="Second")
    second.uv.foreach_set("vector", (1 - rows(mesh.uv_layers[0].uv, "vector", 2)).reshape(-1))
    position = rows(mesh.vertices, "co", 3)
    color = mesh.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
    color.data.foreach_set("color", tinted(position).astype(np.float32).reshape(-1))
    mesh.attributes.new("side", "INT", "FACE").data.foreach_set("value", range(10, 16))
    group = obj.vertex_groups.new(name="fine")
    for i, z in enumerate(position[:, 2]):
        group.add([i], float(z + 1) / 2, "REPLACE")
    group.lock_weight = True
    obj["kept"], mesh["kept too"] = 3, 4
    subdivision = obj.modifiers.new("Subdivision", "SUBSURF")
    subdivision.subdivision_type, subdivision.levels, subdivision.uv_smooth = "SIMPLE", 3, "NONE"
    return obj


def sides_of(vertices, faces):
    """Of each triangle the side of the cube that it lies on: axis and sign."""
    middle = vertices[faces].mean(1)
    axis = np.abs(middle).argmax(1)
    return axis * 2 + (middle[np.arange(len(axis)), axis] > 0)


def test_a_scene_with_modifiers_uvs_materials_colours_groups_and_attributes(box):
    source, faces = rows(box.data.vertices, "co", 3), rows(box.data.polygons, "vertices", 4, np.int32)
    uv = rows(box.data.uv_layers[0].uv, "vector", 2).reshape(-1, 4, 2)
    bpy.ops.object.isoshell_remesh(vertices=3000, density="fine", density_ratio=3)
    mesh = box.data
    vertices, triangles = triangles_of(box)
    assert len(vertices) == 3000 and not box.modifiers and not mesh.validate()
    assert box["kept"] == 3 and mesh["kept too"] == 4

    # Texture coordinates are linear on each side, and jump at some of its edges.
    assert [layer.name for layer in mesh.uv_layers] == ["UVMap", "Second"]
    carried = rows(mesh.uv_layers["UVMap"].uv, "vector", 2).reshape(-1, 3, 2)
    side, side_of_source = sides_of(vertices, triangles), sides_of(source, faces)
    for i, which in enumerate(side_of_source):
        affine = np.linalg.lstsq(np.column_stack([source[faces[i]], np.ones(4)]), uv[i], rcond=None)[0]
        here = triangles[side == which]
        expected = np.concatenate([vertices[here], np.ones((*here.shape, 1))], axis=2) @ affine
        assert np.abs(expected - carried[side == which]).max() < 0.002
    assert np.abs(1 - carried - rows(mesh.uv_layers["Second"].uv, "vector", 2).reshape(-1, 3, 2)).max() < 1e-4

    # Two of six sides are blue, and every face knows the side that it lies on.
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    material = rows(mesh.polygons, "material_index", 1, np.int32)[:, 0]
    assert [m.name for m in mesh.materials] == ["red", "blue"]
    assert area[material == 1].sum() == pytest.approx(8, rel=0.005)
    assert area[material == 0].sum() == pytest.approx(16, rel=0.005)
    number = rows(mesh.attributes["side"].data, "value", 1, np.int32)[:, 0]
    assert np.array_equal(side_of_source[number - 10], side)

    # Colours and weights are linear in the position.
    tint = rows(mesh.color_attributes["Tint"].data, "color", 4)
    assert np.abs(tint - tinted(vertices)).max() < 0.002
    assert [group.name for group in box.vertex_groups] == ["fine"] and box.vertex_groups["fine"].lock_weight
    held = [(v.index, g.weight) for v in mesh.vertices for g in v.groups]
    weights = np.zeros(len(vertices))
    for i, weight in held:
        weights[i] = weight
    assert np.abs(weights - (vertices[:, 2] + 1) / 2).max() < 0.002

    lengths, middles = edge_lengths(vertices, triangles)
    ratio = lengths[middles[:, 2] < -0.9].mean() / lengths[middles[:, 2] > 0.9].mean()
    assert ratio == pytest.approx(3, rel=0.25)


def test_smooth_and_flat_faces_stay_so(box):
    box.data.polygons.foreach_set("use_smooth", [True, False, False, False, False, False])
    smooth_side = sides_of(rows(box.data.vertices, "co", 3), rows(box.data.polygons, "vertices", 4, np.int32))[0]
    bpy.ops.object.isoshell_remesh(vertices=1000)
    smooth = rows(box.data.polygons, "use_smooth", 1, bool)[:, 0]
    assert np.array_equal(smooth, sides_of(*triangles_of(box)) == smooth_side)


def test_colours_of_corners_become_those_of_vertices(box):
    mesh = box.data
    corner = mesh.color_attributes.new("Corner", "BYTE_COLOR", "CORNER")
    position = rows(mesh.vertices, "co", 3)[rows(mesh.loops, "vertex_index", 1, np.int32)[:, 0]]
    corner.data.foreach_set("color_srgb", tinted(position).astype(np.float32).reshape(-1))
    mesh.color_attributes.active_color_name = "Corner"
    bpy.ops.object.isoshell_remesh(vertices=1000)
    assert mesh.attributes["Corner"].domain == "POINT" and mesh.attributes["Corner"].data_type == "BYTE_COLOR"
    assert mesh.color_attributes.active_color_name == "Corner"
    assert np.abs(rows(mesh.attributes["Corner"].data, "color_srgb", 4) - tinted(triangles_of(box)[0])).max() < 0.02


def test_a_mirrored_object_keeps_its_uvs(box):
    box.scale.x = -1
    bpy.context.view_layer.update()
    bpy.ops.object.isoshell_remesh(vertices=1000)
    uv = rows(box.data.uv_layers["UVMap"].uv, "vector", 2).reshape(-1, 3, 2)
    a, b, c = uv[:, 0], uv[:, 1], uv[:, 2]
    turns = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (turns > 0).all() or (turns < 0).all()  # no triangle is torn or turned over
    assert np.abs(turns).sum() / 2 == pytest.approx(6 / 16, rel=0.01)  # six squares of a quarter's side
