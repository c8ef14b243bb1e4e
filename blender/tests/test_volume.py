"""The operator on volumes."""

import bpy
import numpy as np
import pytest
from conftest import assert_closed_manifold, edge_lengths, rows, signed_volume, triangles_of

to_mesh = bpy.ops.object.isoshell_volume_to_mesh


def volume_of_ball():
    """A fog volume of a ball of radius 1, made by a modifier."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=5)
    ball = bpy.context.object
    bpy.ops.object.volume_add()
    obj = bpy.context.object
    modifier = obj.modifiers.new("Mesh to Volume", "MESH_TO_VOLUME")
    modifier.object, modifier.voxel_amount = ball, 64
    bpy.context.view_layer.update()
    return obj


def mesh_by_blender(volume):
    """Vertices in the world that Blender's own modifier makes of it."""
    obj = bpy.data.objects.new("theirs", bpy.data.meshes.new("theirs"))
    bpy.context.scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object, modifier.threshold = volume, 0.5
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return rows(mesh.vertices, "co", 3)


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 2, 2), (1, 1, 3), (-1, 1, 3)])
def test_a_volume_that_a_modifier_makes_becomes_a_mesh_that_is_even_in_the_world(scale):
    source = volume_of_ball()
    path = bpy.app.tempdir + "ball.vdb"
    grids = source.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.grids
    assert grids.save(filepath=path)
    bpy.ops.object.volume_import(filepath=path)
    volume = bpy.context.object
    volume.scale, volume.location = scale, (1, 2, 3)
    bpy.context.view_layer.update()
    assert to_mesh(by="LENGTH", edge_length=0.2, threshold=0.5) == {"FINISHED"}
    obj = bpy.context.object
    bpy.context.view_layer.update()
    assert obj.type == "MESH" and obj.matrix_world == volume.matrix_world
    vertices, faces = triangles_of(obj)
    lengths, _ = edge_lengths(vertices, faces)
    assert_closed_manifold(faces, len(vertices))
    assert lengths.mean() == pytest.approx(0.2, rel=0.1) and lengths.std() / lengths.mean() < 0.15
    local = np.array(obj.matrix_world.inverted())[:3, :3] @ (vertices - obj.location).T
    assert signed_volume(local.T, faces) > 2.5  # outward in the object, as Blender has it
    theirs = mesh_by_blender(volume)
    half_a_voxel = 0.03 * np.abs(scale)  # older Blenders took the voxels' corners for their middles
    assert (np.abs(vertices.min(0) - theirs.min(0)) < half_a_voxel).all()
    assert (np.abs(vertices.max(0) - theirs.max(0)) < half_a_voxel).all()


def test_a_volume_without_a_file_becomes_a_mesh():
    volume_of_ball()
    assert to_mesh(vertices=500, threshold=0.5, grid="density") == {"FINISHED"}
    vertices, faces = triangles_of(bpy.context.object)
    assert len(vertices) == 500
    assert_closed_manifold(faces, 500)


def test_a_grid_that_is_not_there_is_refused_by_name():
    volume_of_ball()
    with pytest.raises(RuntimeError, match="has no grid smoke; its grids are density"):
        to_mesh(grid="smoke")
