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


def level_set_of_ball(radius, voxel):
    """Of a file, made by geometry nodes, whose grids of distances Blender 5.0 has first."""
    tree = bpy.data.node_groups.new("distances", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    ball, grid, store, out = (tree.nodes.new(kind) for kind in (
        "GeometryNodeMeshIcoSphere", "GeometryNodeMeshToSDFGrid", "GeometryNodeStoreNamedGrid", "NodeGroupOutput"))
    ball.inputs["Radius"].default_value, ball.inputs["Subdivisions"].default_value = radius, 6
    grid.inputs["Voxel Size"].default_value = voxel
    store.inputs["Name"].default_value = "surface"
    tree.links.new(ball.outputs["Mesh"], grid.inputs["Mesh"])
    tree.links.new(grid.outputs[0], store.inputs["Grid"])
    tree.links.new(store.outputs[0], out.inputs[0])
    bpy.ops.object.volume_add()
    made = bpy.context.object
    made.modifiers.new("Nodes", "NODES").node_group = tree
    bpy.context.view_layer.update()
    return made


def imported(made, folder):
    """The volume of a file that holds what the modifiers of another one make. Blender remembers grids by the file's
    name, so the folder must be new."""
    path = str(folder / "made.vdb")
    assert made.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.grids.save(filepath=path)
    bpy.ops.object.volume_import(filepath=path)
    return bpy.context.object


def across(obj):
    return np.ptp(triangles_of(obj)[0], axis=0).mean()


def mesh_by_blender(volume):
    """Vertices in the world that Blender's own modifier makes of it."""
    obj = bpy.data.objects.new("theirs", bpy.data.meshes.new("theirs"))
    bpy.context.scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("Volume to Mesh", "VOLUME_TO_MESH")
    modifier.object, modifier.threshold = volume, 0.5
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return rows(mesh.vertices, "co", 3)


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, 2, 2), (1, 1, 3), (-1, 1, 3)])
def test_a_volume_that_a_modifier_makes_becomes_a_mesh_that_is_even_in_the_world(scale, tmp_path):
    volume = imported(volume_of_ball(), tmp_path)
    volume.scale, volume.location = scale, (1, 2, 3)
    bpy.context.view_layer.update()
    assert to_mesh(by="LENGTH", edge_length=0.2, iso=0.5) == {"FINISHED"}
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
    assert to_mesh(vertices=500, iso=0.5, grid="density") == {"FINISHED"}
    vertices, faces = triangles_of(bpy.context.object)
    assert len(vertices) == 500
    assert_closed_manifold(faces, 500)


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, 3)])
def test_values_of_grids_are_attributes_of_the_mesh(scale):
    volume = volume_of_ball()
    volume.scale = scale
    bpy.context.view_layer.update()
    assert to_mesh(vertices=500, iso=0.5, grids="density") == {"FINISHED"}
    density = rows(bpy.context.object.data.attributes["density"].data, "value", 1)
    assert len(density) == 500 and abs(density.mean() - 0.5) < 0.1


def test_a_grid_that_is_not_there_is_refused_by_name():
    volume_of_ball()
    with pytest.raises(RuntimeError, match="has no grid smoke; its grids are density"):
        to_mesh(grid="smoke")


class Layout:
    """What of a panel's layout is asked for."""

    def __init__(self):
        self.labels, self.props = [], []

    def label(self, text):
        self.labels.append(text)

    def prop(self, _owner, name, **_look):
        self.props.append(name)

    def box(self):
        return self

    def column(self):
        return self


def panel_of(volume):
    from bl_ext.user_default.isoshell.volume_source import grid_of

    settings, layout = bpy.context.scene.isoshell_volume_to_mesh, Layout()
    settings.draw_extract(layout, grid_of(volume, settings.grid))
    return layout


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="made by nodes of Blender 5.0")
@pytest.mark.parametrize("of_file", [True, False])
def test_the_surface_of_a_level_set_is_where_its_distances_are_0(of_file, tmp_path):
    volume = level_set_of_ball(radius=10, voxel=0.2)
    volume = imported(volume, tmp_path) if of_file else volume
    assert to_mesh(vertices=3000) == {"FINISHED"}
    assert across(bpy.context.object) == pytest.approx(20, abs=0.03)
    if of_file:
        layout = panel_of(volume)
        assert layout.labels[:2] == ["surface: level set", "Surface at 0"] and "iso" not in layout.props
    bpy.context.view_layer.objects.active = volume
    assert to_mesh(vertices=3000, iso=0.1) == {"FINISHED"}  # as a script asks for it
    assert across(bpy.context.object) == pytest.approx(20.2, abs=0.03)


def test_the_surface_of_a_fog_volume_is_where_that_of_blender_is(tmp_path):
    volume = imported(volume_of_ball(), tmp_path)
    panel = panel_of(volume)
    assert panel.labels[0] == "density: fog volume" and "iso" in panel.props and "use_iso" not in panel.props
    sizes = []
    for words in ({}, {"iso": 0.1}, {"iso": 0.9}):
        bpy.context.view_layer.objects.active = volume
        assert to_mesh(vertices=500, **words) == {"FINISHED"}
        sizes.append(across(bpy.context.object))
    assert sizes[0] == sizes[1] > sizes[2]


def test_grids_of_the_volume_are_offered_by_name(tmp_path):
    from bl_ext.user_default.isoshell.options import names_of_grids

    volume = imported(volume_of_ball(), tmp_path)
    assert names_of_grids(None, bpy.context, "") == names_of_grids(None, bpy.context, "den") == ["density"]
    assert names_of_grids(None, bpy.context, "v, ") == ["v,density"]
    assert names_of_grids(None, bpy.context, "density,") == []
    bpy.context.view_layer.objects.active = None
    assert volume and names_of_grids(None, bpy.context, "") == []
