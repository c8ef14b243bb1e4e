"""The operator on meshes: what becomes of their shape."""

import bpy
import numpy as np
import pytest
from conftest import assert_closed_manifold, edge_lengths, rows, signed_volume, triangles_of

remesh = bpy.ops.object.isoshell_remesh


def ball(name="ball", scale=(1, 1, 1)):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1, location=(5, 6, 7), calc_uvs=False)
    obj = bpy.context.object
    obj.name, obj.scale = name, scale
    bpy.context.view_layer.update()
    return obj


def test_the_monkey_with_a_subdivision_modifier_becomes_one_closed_mesh():
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    assert remesh(vertices=2000) == {"FINISHED"}
    vertices, faces = triangles_of(obj)
    assert len(vertices) == 2000 and not obj.modifiers and not obj.data.validate()
    assert_closed_manifold(faces, 2000)
    assert signed_volume(vertices, faces) > 1.5


def angles_of(vertices, faces):
    """Of each triangle the three angles in degrees."""
    corner = vertices[faces]
    to_next, to_last = np.roll(corner, -1, axis=1) - corner, np.roll(corner, 1, axis=1) - corner
    cosine = np.einsum("nij,nij->ni", to_next, to_last)
    cosine /= np.linalg.norm(to_next, axis=2) * np.linalg.norm(to_last, axis=2)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def longest_side(corners):
    return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(1)


def uv_per_length(obj):
    """Of each face the longest side in its UV map over the longest one in space."""
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    mesh.calc_loop_triangles()
    position, uv = rows(mesh.vertices, "co", 3), rows(mesh.uv_layers[0].uv, "vector", 2)
    return longest_side(uv[rows(mesh.loop_triangles, "loops", 3, np.int32)]) / \
        longest_side(position[rows(mesh.loop_triangles, "vertices", 3, np.int32)])


def monkey_with_uvs():
    bpy.ops.mesh.primitive_monkey_add()
    obj = bpy.context.object
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.context.view_layer.update()
    assert obj.data.uv_layers
    return obj


@pytest.mark.parametrize("count", [3000, 10000])
def test_the_monkey_with_uvs_has_wide_angles_even_edges_and_no_triangle_on_two_islands(count):
    obj = monkey_with_uvs()
    largest = uv_per_length(obj).max()
    remesh(vertices=count)
    vertices, faces = triangles_of(obj)
    lengths, _ = edge_lengths(vertices, faces)
    assert_closed_manifold(faces, len(vertices))
    assert len(vertices) == count and angles_of(vertices, faces).min() >= 39
    assert lengths.max() < 3 * lengths.min()
    assert uv_per_length(obj).max() < 2 * largest  # from one island to another it would be above ten times as much


@pytest.mark.parametrize("keep", [False, True])
def test_seams_of_uvs_are_edges_where_they_are_to_be_kept(keep):
    """A ball with an island for each half."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=1)
    obj = bpy.context.object
    mesh = obj.data
    loops = rows(mesh.loops, "vertex_index", 1, np.int32)[:, 0]
    uv = rows(mesh.vertices, "co", 3)[loops, :2]
    for polygon in mesh.polygons:
        uv[polygon.loop_indices, 0] += 10 * (polygon.center.z > 0)
    mesh.uv_layers[0].uv.foreach_set("vector", uv.reshape(-1))
    remesh(vertices=1000, keep_uv_seams=keep)
    vertices, faces = triangles_of(obj)
    height = vertices[faces][:, :, 2]
    reach = np.minimum(height.max(1), -height.min(1)).max()
    assert reach < 1e-3 if keep else reach > 0.01
    carried = rows(mesh.uv_layers[0].uv, "vector", 2).reshape(-1, 3, 2)
    upper = carried[:, :, 0] > 5
    assert (upper.all(1) | ~upper.any(1)).all() and np.array_equal(upper[:, 0], height.mean(1) > 0)
    expected = vertices[faces][:, :, :2] + np.stack([10 * upper, np.zeros(upper.shape)], axis=2)
    assert np.abs(carried - expected).max() < (0.02 if keep else 0.1)  # a corner beyond a seam has what the seam has


@pytest.mark.parametrize("scale", [(1, 1, 1), (0.5, 1, 2), (-1, 1, 1), (-3, 1, 1)])
def test_edges_are_even_in_the_world_whatever_the_scale_of_the_object_is(scale):
    obj = ball(scale=scale)
    obj.rotation_euler = (0.3, 0.5, 0.7)
    bpy.context.view_layer.update()
    before, faces = triangles_of(obj)
    volume = signed_volume(before, faces)
    remesh(by="LENGTH", edge_length=0.15)
    after, faces = triangles_of(obj)
    lengths, _ = edge_lengths(after, faces)
    assert_closed_manifold(faces, len(after))
    assert lengths.mean() == pytest.approx(0.15, rel=0.1) and lengths.std() / lengths.mean() < 0.15
    assert np.abs(after.min(0) - before.min(0)).max() < 0.02
    assert signed_volume(after, faces) == pytest.approx(volume, rel=0.02)
    assert tuple(obj.scale) == scale and obj.location.x == 5


def test_weights_of_a_vertex_group_are_the_density():
    for by in ("COUNT", "LENGTH"):
        obj = ball()
        height = rows(obj.data.vertices, "co", 3)[:, 2]
        group = obj.vertex_groups.new(name="fine")
        for i, z in enumerate(height):
            group.add([i], float(z > 0), "REPLACE")
        remesh(by=by, vertices=3000, edge_length=0.2, density="fine", density_ratio=3)
        vertices, faces = triangles_of(obj)
        lengths, middles = edge_lengths(vertices - obj.location, faces)
        coarse, fine = lengths[middles[:, 2] < -0.6].mean(), lengths[middles[:, 2] > 0.6].mean()
        assert coarse / fine == pytest.approx(3, rel=0.12)
        assert len(vertices) == 3000 if by == "COUNT" else coarse == pytest.approx(0.2, rel=0.1)


def test_borders_are_closed_or_kept():
    for boundary, euler in (("CLOSE", 2), ("KEEP", 1)):
        obj = ball()
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bisect(plane_co=(5, 6, 7), plane_no=(0, 0, 1), clear_inner=True)
        bpy.ops.object.mode_set(mode="OBJECT")
        remesh(vertices=500, boundary=boundary, gaps="NONE")
        mesh = obj.data
        assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == euler


def test_creases_stay_as_edges_or_are_rounded_off():
    for features, corners_kept in (("AUTO", True), ("ANGLE", True), ("OFF", False)):
        bpy.ops.mesh.primitive_cube_add(size=2, calc_uvs=False)
        bpy.ops.object.shade_smooth()
        obj = bpy.context.object
        remesh(vertices=800, features=features)
        vertices, _ = triangles_of(obj)
        distance = np.linalg.norm(vertices - (1, 1, 1), axis=1).min()
        assert (distance < 1e-5) == corners_kept
        assert any(edge.use_edge_sharp for edge in obj.data.edges) == corners_kept


def test_modifiers_can_stay():
    obj = ball()
    obj.modifiers.new("Decimate", "DECIMATE").ratio = 0.5
    remesh(vertices=400, apply_modifiers=False)
    assert len(obj.data.vertices) == 400 and len(obj.modifiers) == 1


def test_a_modifier_that_the_viewport_does_not_show_stays():
    obj = ball()
    obj.modifiers.new("Hidden", "DECIMATE").show_viewport = False
    obj.modifiers.new("Shown", "DECIMATE").ratio = 0.5
    remesh(vertices=400)
    assert [modifier.name for modifier in obj.modifiers] == ["Hidden"]


def test_other_objects_of_the_same_mesh_keep_theirs():
    obj = ball()
    other = bpy.data.objects.new("other", obj.data)
    shared, count = obj.data, len(obj.data.vertices)
    remesh(vertices=400)
    assert other.data == shared and len(shared.vertices) == count
    assert len(obj.data.vertices) == 400 and obj.data != shared


def test_shape_keys_end_in_the_shape_that_they_have():
    obj = ball()
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Long")
    for point in key.data:
        point.co.z *= 3
    key.value = 0.5
    remesh(vertices=400)
    assert obj.data.shape_keys is None
    assert max(vertex.co.z for vertex in obj.data.vertices) == pytest.approx(2, rel=0.02)


def test_undo_brings_the_mesh_back():
    obj = ball()
    obj.modifiers.new("Decimate", "DECIMATE").ratio = 0.5
    obj.data.materials.append(bpy.data.materials.new("red"))
    before = rows(obj.data.vertices, "co", 3)
    bpy.ops.ed.undo_push(message="before")
    remesh("EXEC_DEFAULT", True, vertices=400)
    assert len(bpy.data.objects["ball"].data.vertices) == 400
    assert bpy.ops.ed.undo() == {"FINISHED"}
    obj = bpy.data.objects["ball"]
    assert np.array_equal(rows(obj.data.vertices, "co", 3), before)
    assert len(obj.modifiers) == 1 and obj.data.materials[0].name == "red"
    bpy.ops.ed.redo()
    assert len(bpy.data.objects["ball"].data.vertices) == 400


def test_the_mesh_is_the_one_that_the_library_makes():
    import isoshell

    obj = ball()
    obj.location = (0, 0, 0)
    bpy.context.view_layer.update()
    made = isoshell.remesh(triangles_of(obj), vertices=500)
    remesh(vertices=500)
    vertices, faces = triangles_of(obj)
    assert np.array_equal(faces, made.faces) and np.array_equal(vertices, made.vertices.astype(np.float32))


def flat(obj):
    obj.scale.z = 0
    bpy.context.view_layer.update()


def without_faces(obj):
    obj.data.clear_geometry()


@pytest.mark.parametrize("harm, options, words", [
    (flat, {}, "its scale along an axis is 0"),
    (without_faces, {}, "has no faces"),
    (lambda obj: None, {"density": "none"}, "has no vertex group none"),
    (lambda obj: None, {"device": "cuda"}, "isoshell, .*cuda|isoshell, .*CUDA"),
])
def test_what_cannot_be_remeshed_is_refused_and_stays(harm, options, words):
    obj = ball()
    harm(obj)
    count = len(obj.data.vertices)
    with pytest.raises(RuntimeError, match=words):
        remesh(**options)
    assert len(obj.data.vertices) == count
