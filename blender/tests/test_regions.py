"""Volumes of labels: what their regions become."""

import bpy
import numpy as np
import pytest
from conftest import assert_closed_manifold, edge_lengths, rows, signed_volume, triangles_of

to_mesh = bpy.ops.object.isoshell_volume_to_mesh
COUNT = 10 * 20 * 20  # voxels of each of both bones


@pytest.fixture
def bones(extension):
    """Two boxes that share a side, with a speck of another label in one of them; what is around them is 0."""
    import isoshell

    for collection in list(bpy.data.collections):
        bpy.data.collections.remove(collection)
    labels = np.zeros((30, 30, 30), np.int16)
    labels[5:15, 5:25, 5:25], labels[15:25, 5:25, 5:25] = 1, 7
    labels[20, 15, 15] = 1
    path = bpy.app.tempdir + "bones.vdb"
    isoshell.Labels(labels, spacing=0.1, names={1: "femur"}).save(path, overwrite=True)
    bpy.ops.object.volume_import(filepath=path)
    obj = bpy.context.object
    obj.name = "knee"
    return obj


def attribute(mesh, name):
    return rows(mesh.attributes[name].data, "value", 1, np.int32)[:, 0]


def volumes_of(vertices, faces, inside, outside):
    """Of the region of each label the volume, which must be closed."""
    volumes = {}
    for label in np.unique([inside, outside]):
        both = np.concatenate([faces[inside == label], faces[outside == label][:, ::-1]])
        directed = both[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
        assert np.array_equal(np.sort(directed @ (len(vertices), 1)), np.sort(directed[:, ::-1] @ (len(vertices), 1)))
        volumes[label] = signed_volume(vertices, both)
    return volumes


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 2, 2), (1, 1, 3), (-1, 1, 3)])
def test_a_grid_of_labels_becomes_one_mesh_with_a_material_for_each_region(bones, scale):
    bones.scale, bones.location = scale, (1, 2, 3)
    bpy.context.view_layer.update()
    assert to_mesh(by="LENGTH", edge_length=0.15) == {"FINISHED"}
    obj = bpy.context.object
    bpy.context.view_layer.update()
    mesh = obj.data
    assert obj.matrix_world == bones.matrix_world and not mesh.validate()
    vertices, faces = triangles_of(obj)
    assert edge_lengths(vertices, faces)[0].mean() == pytest.approx(0.15, rel=0.15)

    inside, outside = attribute(mesh, "region_inside"), attribute(mesh, "region_outside")
    assert set(zip(inside.tolist(), outside.tolist())) == {(1, 0), (1, 7), (7, 0)}
    local = np.array(obj.matrix_world.inverted())[:3, :3] @ (vertices - obj.location).T
    volumes = volumes_of(local.T, faces, inside, outside)
    assert volumes[1] == pytest.approx(COUNT * 0.1**3, rel=0.03)
    assert volumes[7] == pytest.approx(COUNT * 0.1**3, rel=0.03)

    assert [material.name for material in mesh.materials] == ["femur", "Region 7"]
    slot = rows(mesh.polygons, "material_index", 1, np.int32)[:, 0]
    assert np.array_equal(slot, inside == 7)
    colors = [tuple(material.diffuse_color) for material in mesh.materials]
    for material, color in zip(mesh.materials, colors):
        assert tuple(material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value) == color
    assert np.abs(np.subtract(*colors)).max() > 0.2
    sharp = rows(mesh.edges, "use_edge_sharp", 1, bool)[:, 0]
    assert sharp.any() and not sharp.all()


def test_regions_are_split_into_closed_objects_of_a_collection(bones):
    bones.location = (1, 2, 3)
    assert to_mesh(vertices=1500, split_regions=True) == {"FINISHED"}
    collection = bpy.data.collections["knee"]
    bpy.context.view_layer.update()
    assert {obj.name: [m.name for m in obj.data.materials] for obj in collection.objects} == \
        {"femur": ["femur"], "Region 7": ["Region 7"]}
    assert [obj.name for obj in bpy.data.objects if obj.type == "MESH" and obj not in list(collection.objects)] == []
    for obj in collection.objects:
        vertices, faces = triangles_of(obj)
        assert_closed_manifold(faces, len(vertices))
        assert obj.matrix_world == bones.matrix_world and obj.select_get()
        assert signed_volume(vertices, faces) == pytest.approx(COUNT * 0.1**3, rel=0.03)


def test_the_background_and_small_islands_are_as_the_options_say(bones):
    to_mesh(vertices=1500, smallest_island=0)
    speck = bpy.context.object
    bpy.context.view_layer.objects.active = bones
    to_mesh(vertices=1500, use_background=True, background=7)
    without = bpy.context.object
    assert len(speck.data.materials) == 2 and [m.name for m in without.data.materials] == ["Region 0", "femur"]
    pairs = set(zip(attribute(speck.data, "region_inside").tolist(), attribute(speck.data, "region_outside").tolist()))
    assert pairs == {(1, 0), (1, 7), (7, 0)}
    vertices, faces = triangles_of(speck)
    inner = np.linalg.norm(vertices - (2, 1.5, 1.5), axis=1) < 0.2
    assert inner.any()


def test_a_second_run_keeps_the_colours_that_were_chosen(bones):
    chosen = bpy.data.materials.new("femur")
    chosen.diffuse_color = (1, 0, 0, 1)
    to_mesh(vertices=1500)
    assert bpy.context.object.data.materials[0] == chosen and tuple(chosen.diffuse_color) == (1, 0, 0, 1)
