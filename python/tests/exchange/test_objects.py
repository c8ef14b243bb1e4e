"""Meshes, grids, clouds and images of other packages as sources."""

import isoshell
import numpy as np
import pytest
from conftest import make_ball
from test_sources import TURNED, ball_values, check_ball, radii, turned_ball

SMALL = {"vertices": 100, "resolution": 32}


def digest(source, **options):
    return isoshell.remesh(source, **SMALL, **options).digest


def dropped(result):
    return {entry["name"]: entry["reason"] for entry in result.report["attributes"]["dropped"]}


def quiet(source, **options):
    """Nothing is to be warned of."""
    return isoshell.remesh(source, **SMALL, **options)


def test_a_mesh_of_trimesh_brings_its_colours_texture_attributes_and_normals(ball):
    trimesh = pytest.importorskip("trimesh")
    vertices, faces = ball
    colors = np.column_stack([np.rint(255 * (vertices + 1) / 2), np.full(len(vertices), 255)]).astype(np.uint8)
    mesh = trimesh.Trimesh(vertices, faces, vertex_colors=colors, process=False,
                           vertex_attributes={"heat": vertices[:, 2], "flow": vertices * 2, "words": ["a"] * len(vertices)},
                           face_attributes={"part": np.arange(len(faces)) % 3})
    result = isoshell.remesh(mesh, **SMALL)
    assert {"color", "heat", "flow.0", "flow.1", "flow.2", "part"} == set(result.report["attributes"]["kept"])
    assert "texts" in dropped(result)["words"] and "normal" not in result.attributes
    assert np.allclose(result.attributes["color"], 255 * (result.vertices + 1) / 2, atol=4)
    back = result.to_trimesh()
    assert np.array_equal(back.vertex_attributes["flow"], np.column_stack([result.attributes[f"flow.{i}"] for i in range(3)]))
    assert np.array_equal(back.face_attributes["part"], result.attributes["part"]) and back.is_watertight

    by_face = trimesh.Trimesh(vertices, faces, face_colors=np.tile([9, 8, 7, 255], (len(faces), 1)), process=False)
    assert (isoshell.remesh(by_face, **SMALL).attributes["color"] == [9, 8, 7]).all()
    given = trimesh.Trimesh(vertices, faces, vertex_normals=vertices * [1, 1, -1], process=False)
    looked_at = trimesh.Trimesh(vertices, faces, process=False)
    looked_at.vertex_normals
    assert "normal" in isoshell.remesh(given, **SMALL).attributes
    assert "normal" not in isoshell.remesh(looked_at, **SMALL).attributes


def test_a_texture_of_trimesh_comes_back(ball):
    trimesh = pytest.importorskip("trimesh")
    image = pytest.importorskip("PIL.Image").new("RGB", (4, 4), (1, 2, 3))
    uv = (ball[0][:, :2] + 1) / 2
    visual = trimesh.visual.TextureVisuals(uv=uv, material=trimesh.visual.material.PBRMaterial(baseColorTexture=image))
    result = isoshell.remesh(trimesh.Trimesh(*ball, visual=visual, process=False), **SMALL)
    back = result.to_trimesh()
    assert back.visual.material is visual.material
    assert np.allclose(back.visual.uv, (back.vertices[:, :2] + 1) / 2, atol=0.02)


def test_a_scene_of_trimesh_is_one_mesh_where_its_nodes_put_it(ball):
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    first = trimesh.Trimesh(*ball, process=False, vertex_attributes={"heat": ball[0][:, 2]})
    second = trimesh.Trimesh(*ball, process=False, vertex_colors=np.tile([9, 8, 7, 128], (len(ball[0]), 1)))
    scene.add_geometry(first, geom_name="a")
    scene.add_geometry(second, geom_name="b", transform=trimesh.transformations.translation_matrix((5, 0, 0)))
    result = isoshell.remesh(scene, vertices=200)
    assert result.report["topology"]["components"] == 2 and result.vertices[:, 0].max() == pytest.approx(6, abs=0.05)
    right = result.vertices[:, 0] > 3
    assert (result.attributes["color"][right] == [9, 8, 7, 128]).all()
    assert np.allclose(result.attributes["heat"][~right], result.vertices[~right, 2], atol=0.05)


def test_a_cloud_of_trimesh_is_points(ball):
    trimesh = pytest.importorskip("trimesh")
    assert digest(trimesh.PointCloud(ball[0])) == digest(isoshell.Points(ball[0]))
    with pytest.raises(isoshell.Error, match="no faces"):
        isoshell.remesh(trimesh.load_path(ball[0][:5]))


def poly_data(pyvista, ball):
    rows = np.column_stack([np.full(len(ball[1]), 3), ball[1]])
    return pyvista.PolyData(ball[0], rows.ravel())


def test_data_of_pyvista_comes_along(ball):
    pyvista = pytest.importorskip("pyvista")
    mesh = poly_data(pyvista, ball)
    mesh.point_data["heat"], mesh.point_data["flow"] = ball[0][:, 2], ball[0] * 2
    mesh.cell_data["part"] = np.arange(mesh.n_cells) % 3
    mesh.point_data["RGB"] = np.full((mesh.n_points, 3), 7, np.uint8)
    mesh.active_texture_coordinates = (ball[0][:, :2] + 1) / 2
    mesh.point_data["Normals"] = ball[0]
    mesh.point_data["wave"] = ball[0][:, 0] + 1j
    result = isoshell.remesh(mesh, **SMALL)
    assert {"heat", "flow.0", "flow.1", "flow.2", "part", "color", "uv", "normal"} == set(result.report["attributes"]["kept"])
    assert "complex" in dropped(result)["wave"]
    back = result.to_pyvista()
    assert back.active_texture_coordinates is not None and back.point_data.active_normals_name == "normal"
    assert np.allclose(back.point_data["flow"], 2 * back.points, atol=0.05)


def test_grids_of_pyvista_are_their_surface_and_points_without_faces_a_cloud(ball):
    pyvista = pytest.importorskip("pyvista")
    mesh = poly_data(pyvista, ball)
    mesh.point_data["heat"] = ball[0][:, 2]
    made = isoshell.remesh(mesh.cast_to_unstructured_grid(), **SMALL)
    assert made.digest == digest(ball) and "heat" in made.attributes
    solid = pyvista.ImageData(dimensions=(5, 5, 5)).cast_to_unstructured_grid()
    assert isoshell.remesh(solid, **SMALL).vertices.max() == pytest.approx(4, abs=0.05)
    assert isoshell.remesh(pyvista.MultiBlock([mesh, mesh.translate((5, 0, 0))]), **SMALL).vertices[:, 0].max() > 5
    assert digest(pyvista.PolyData(ball[0])) == digest(isoshell.Points(ball[0]))
    assert digest(pyvista.PointSet(ball[0])) == digest(isoshell.Points(ball[0]))
    cloud = pyvista.PolyData(ball[0])
    cloud.point_data.active_normals = ball[0]
    assert digest(cloud) == digest(isoshell.Points(ball[0], normals=cloud.point_data.active_normals))


def test_an_image_of_pyvista_is_a_volume():
    pyvista = pytest.importorskip("pyvista")
    values, spacing, origin = ball_values()
    image = pyvista.ImageData(dimensions=values.shape, spacing=spacing, origin=origin)
    image.point_data["distance"] = values.ravel(order="F")
    assert digest(image) == digest(isoshell.Volume(values, spacing, origin))
    image.direction_matrix = [[0, -1, 0], [0.8, 0, -0.6], [0.6, 0, 0.8]]
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = image.direction_matrix * np.array(spacing), origin
    assert digest(image) == digest(isoshell.Volume(values, affine=affine))
    cells = pyvista.ImageData(dimensions=np.array(values.shape) + 1, spacing=spacing,
                              origin=np.array(origin) - np.array(spacing) / 2)
    cells.cell_data["distance"] = values.ravel(order="F")
    assert np.allclose(radii(isoshell.remesh(cells, **SMALL)), 1, atol=0.05)
    with pytest.raises(isoshell.Error, match="active scalars"):
        isoshell.remesh(pyvista.ImageData(dimensions=(3, 3, 3)))


def test_meshes_of_meshio_are_their_faces_or_the_boundary_of_their_volume_cells(ball):
    meshio = pytest.importorskip("meshio")
    faces = [("triangle", ball[1][:100]), ("triangle", ball[1][100:])]
    parts = [np.zeros(100, np.int32), np.ones(len(ball[1]) - 100, np.int32)]
    made = isoshell.remesh(meshio.Mesh(ball[0], faces, point_data={"heat": ball[0][:, 2]}, cell_data={"part": parts}), **SMALL)
    assert made.digest == digest(ball) and {"heat", "part"} == set(made.report["attributes"]["kept"])
    points = np.stack(np.meshgrid(range(4), range(4), range(4), indexing="ij"), -1).reshape(-1, 3).astype(float)
    at = np.arange(64).reshape(4, 4, 4)
    cubes = np.stack([at[:-1, :-1, :-1], at[1:, :-1, :-1], at[1:, 1:, :-1], at[:-1, 1:, :-1], at[:-1, :-1, 1:],
                      at[1:, :-1, 1:], at[1:, 1:, 1:], at[:-1, 1:, 1:]], -1).reshape(-1, 8)
    solid = isoshell.remesh(meshio.Mesh(points, [("hexahedron", cubes)], point_data={"x": points[:, 0]},
                                        cell_data={"E": [np.arange(27.0)]}), **SMALL)
    assert solid.report["topology"]["closed"] and np.allclose(solid.attributes["x"], solid.vertices[:, 0], atol=0.05)
    assert "volume cells" in dropped(solid)["E"]
    volume = np.cross(*(solid.vertices[solid.faces[:, i]] for i in (0, 1)))
    assert np.einsum("ij,ij->", volume, solid.vertices[solid.faces[:, 2]]) / 6 == pytest.approx(27, rel=0.05)
    assert digest(meshio.Mesh(ball[0], [])) == digest(isoshell.Points(ball[0]))


def test_physical_groups_of_gmsh_are_groups(ball):
    meshio = pytest.importorskip("meshio")
    upper = ball[0][ball[1]][:, :, 2].mean(1) > 0
    mesh = meshio.Mesh(ball[0], [("triangle", ball[1])], cell_data={"gmsh:physical": [np.where(upper, 5, 9)]},
                       field_data={"inlet": np.array([5, 2]), "wall": np.array([9, 2])})
    result = isoshell.remesh(mesh, vertices=300)
    names = np.array(result.labels["group"])[result.attributes["group"]]
    height = result.vertices[result.faces][:, :, 2].mean(1)
    assert (names[height > 0.1] == "inlet").all() and (names[height < -0.1] == "wall").all()


@pytest.mark.parametrize("note", [1.0, np.array(7), [5.5, 2.0], "text", [2**40, 2], [[5, 2]], [2_000_000_000, 2], [-1, 2]])
def test_notes_of_meshio_that_are_somebody_elses_are_left_alone(ball, note):
    meshio = pytest.importorskip("meshio")
    parts = np.arange(len(ball[1])) % 2
    mesh = meshio.Mesh(ball[0], [("triangle", ball[1])], cell_data={"part": [parts], "gmsh:physical": [parts + 5]})
    mesh.field_data = {"time": note, "part:a": np.array([0, 2]), "part:b": np.array([1, 2]), "part:c": note,
                       "region:d": note, "region_background:": note, "inlet": np.array([5, 2])}
    made = isoshell.remesh(mesh, **SMALL)
    assert made.labels["part"][:2] == ["a", "b"] and "inlet" in made.labels["group"]


def test_numbers_of_gmsh_are_of_its_own_mesh(ball):
    meshio = pytest.importorskip("meshio")
    count = len(ball[1])
    made = isoshell.remesh(meshio.Mesh(
        ball[0], [("triangle", ball[1])], point_data={"gmsh:dim_tags": np.ones((len(ball[0]), 2), int)},
        cell_data={"gmsh:geometrical": [np.ones(count, int)]}), **SMALL)
    assert {"gmsh:dim_tags", "gmsh:geometrical"} <= set(dropped(made)) and not made.attributes


def test_texture_coordinates_of_gltf_are_numbered_from_0(ball):
    trimesh = pytest.importorskip("trimesh")
    uv = (ball[0][:, :2] + 1) / 2
    given = trimesh.Trimesh(*ball, vertex_attributes={"TEXCOORD_0": uv, "TEXCOORD_1": uv}, process=False)
    assert {"uv", "uv1"} == set(isoshell.remesh(given, **SMALL).attributes)


def test_regions_with_labels_alone_are_given(ball):
    pytest.importorskip("trimesh")
    mesh = isoshell.Mesh(*ball, regions={"labels": np.tile([4, 0], (len(ball[1]), 1))})
    assert (mesh.to_trimesh().face_attributes["region_inside"] == 4).all()


def test_meshes_of_pymeshlab_and_their_sets_are_sources(ball):
    pymeshlab = pytest.importorskip("pymeshlab")
    colors = np.column_stack([(ball[0] + 1) / 2, np.ones(len(ball[0]))])
    mesh = pymeshlab.Mesh(ball[0], ball[1].astype(np.int32), v_color_matrix=colors, v_scalar_array=ball[0][:, 2])
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(mesh)
    for source in (mesh, meshes):
        made = isoshell.remesh(source, **SMALL)
        assert {"color", "scalar"} <= set(made.attributes)
        assert np.allclose(made.attributes["scalar"], made.vertices[:, 2], atol=0.05)


def image_of(nibabel, values, affine):
    return nibabel.Nifti1Image(values, np.array(affine, float))


def test_an_image_of_whole_numbers_is_labels_with_its_affine():
    nibabel = pytest.importorskip("nibabel")
    labels = np.zeros((12, 9, 8), np.int16)
    labels[2:6, 2:6, 2:6], labels[6:10, 2:6, 2:6] = 3, 7
    affine = np.array([[-0.8, 0.1, 0, 20], [0, 1.1, 0.2, -3], [0, 0, 2, 5], [0, 0, 0, 1]])
    expected = isoshell.remesh(isoshell.Labels(labels, affine=affine), vertices=200)
    assert isoshell.remesh(image_of(nibabel, labels, affine), vertices=200).digest == expected.digest
    as_floats = image_of(nibabel, labels.astype(np.float32), affine)
    assert isoshell.remesh(as_floats, vertices=200).digest == expected.digest


@pytest.mark.parametrize("option", ["background", "smallest_island"])
def test_options_of_an_image_of_labels_are_whole_numbers(option):
    nibabel = pytest.importorskip("nibabel")
    labels = np.zeros((8, 8, 8), np.int16)
    labels[2:6, 2:6, 2:6] = 3
    image = image_of(nibabel, labels, np.eye(4))
    for value in (0.7, "many", True, "0.7"):
        with pytest.raises(isoshell.Error, match=f"{option} is") as caught:
            isoshell.remesh(image, vertices=100, **{option: value})
        assert caught.value.code == isoshell.ErrorCode.USAGE
    for value in (0.0, "0", np.int64(0)):
        assert isoshell.remesh(image, vertices=100, **{option: value}).report["topology"]["closed"]
    smooth = isoshell.remesh(image, vertices=100, smoothing=1)
    assert smooth.digest == isoshell.remesh(isoshell.Labels(labels, affine=np.eye(4), smoothing=1), vertices=100).digest


def test_an_image_of_values_is_a_volume_turned_as_its_affine_says():
    nibabel = pytest.importorskip("nibabel")
    values, spacing, origin = ball_values()
    affine = np.zeros((4, 4))
    affine[0, 1], affine[1, 0], affine[2, 2], affine[3, 3] = -spacing[0], spacing[1], spacing[2], 1
    affine[:3, 3] = -origin[0], origin[1], origin[2]
    image = image_of(nibabel, values[::1].transpose(1, 0, 2).copy(), affine)
    assert np.allclose(radii(isoshell.remesh(image, **SMALL)), 1, atol=0.05)
    whole = image_of(nibabel, np.rint(1000 - 500 * values.transpose(1, 0, 2)).astype(np.int16), affine)
    assert np.allclose(radii(isoshell.remesh(whole, iso=900, **SMALL)), 1.2, atol=0.05)
    turned, middle = turned_ball()
    check_ball(isoshell.remesh(image_of(nibabel, turned, TURNED), vertices=1500), middle)
    with pytest.raises(isoshell.Error, match="one volume"):
        isoshell.remesh(image_of(nibabel, np.zeros((3, 3, 3, 2), np.int16), affine))


def test_an_object_of_another_package_that_is_no_mesh_is_refused_by_its_name():
    trimesh = pytest.importorskip("trimesh")
    with pytest.raises(isoshell.Error, match="without faces"):
        isoshell.remesh(trimesh.Scene())
    vertices, faces = make_ball()
    with pytest.raises(isoshell.Error, match="Trimesh: a face has vertex"):
        isoshell.remesh(trimesh.Trimesh(vertices, faces + 1000, process=False))
