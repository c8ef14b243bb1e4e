"""Several meshes of another package that are one source keep their regions, or say that they do not."""

import isoshell
import numpy as np
import pytest
from conftest import make_ball
from isoshell._exchange import taken

SMALL = {"vertices": 300, "resolution": 40}


def ball_with(label, name=None, background=0, at=0.0):
    """A ball that is one region."""
    vertices, faces = make_ball()
    names = {} if name is None else {label: name}
    return isoshell.Mesh(vertices + [at, 0, 0], faces, regions={
        "labels": np.tile([label, background], (len(faces), 1)), "background": background, "names": names})


def scene_of(meshes):
    trimesh = pytest.importorskip("trimesh")
    return trimesh.Scene([mesh.to_trimesh() for mesh in meshes])


def blocks_of(meshes):
    pyvista = pytest.importorskip("pyvista")
    first, *others = [mesh.to_pyvista() for mesh in meshes]
    return pyvista.MultiBlock([first, pyvista.MultiBlock(others), None])


@pytest.fixture(params=[scene_of, blocks_of])
def carrier(request):
    return request.param


def test_regions_of_several_meshes_are_regions_of_the_result(carrier):
    source = carrier([ball_with(1), ball_with(1, at=3), ball_with(4, "core", at=6)])
    result = isoshell.remesh(source, **SMALL)
    assert [region["label"] for region in result.report["regions"]["regions"]] == [1, 2, 4]
    assert result.region_names == {4: "core"}
    for label, middle in ((1, 0), (2, 3), (4, 6)):
        assert result.region(label).vertices[:, 0].mean() == pytest.approx(middle, abs=0.2)


def test_regions_of_one_name_are_one_region_and_of_two_names_are_two(carrier):
    source = taken(carrier([ball_with(1, "bone"), ball_with(1, "skin"), ball_with(7, "bone"), ball_with(2)]), {})
    first = source.regions["labels"].reshape(4, -1, 2)[:, 0]
    assert first.tolist() == [[1, 0], [2, 0], [1, 0], [3, 0]]
    assert source.regions["names"] == {1: "bone", 2: "skin"} and source.regions["background"] == 0


def test_every_mesh_may_have_a_background_of_its_own(carrier):
    source = taken(carrier([ball_with(1, background=9), ball_with(9, background=0)]), {})
    first = source.regions["labels"].reshape(2, -1, 2)[:, 0]
    assert first.tolist() == [[1, 9], [10, 9]] and source.regions["background"] == 9


def test_regions_that_only_some_meshes_have_are_left_out_with_a_warning(carrier):
    source = carrier([ball_with(1), isoshell.Mesh(*make_ball()), ball_with(2)])
    with pytest.warns(isoshell.RunWarning, match="the regions of 2 of 3 meshes are left out") as told:
        source = taken(source, {})
    assert len(told) == 1 and source.regions is None and len(source.faces) == 3 * len(make_ball()[1])


def test_blocks_keep_what_only_some_of_them_have():
    pytest.importorskip("pyvista")
    meshes = [isoshell.Mesh(*make_ball(), of_faces={"heat": np.ones(len(make_ball()[1]))}), isoshell.Mesh(*make_ball())]
    heat = taken(blocks_of(meshes), {}).of_faces["heat"].reshape(2, -1)
    assert (heat[0] == 1).all() and np.isnan(heat[1]).all()


def test_blocks_may_be_grids_and_points_without_faces_are_left_out():
    pyvista = pytest.importorskip("pyvista")
    cube = pyvista.ImageData(dimensions=(3, 3, 3))
    blocks = pyvista.MultiBlock([cube, pyvista.PolyData([[9.0, 9, 9]]), cube.cast_to_unstructured_grid()])
    assert isoshell.remesh(blocks, **SMALL).vertices.max() < 2.1
    points = pyvista.MultiBlock([pyvista.PolyData(make_ball()[0])])
    assert isoshell.remesh(points, **SMALL).digest == isoshell.remesh(isoshell.Points(make_ball()[0]), **SMALL).digest


def test_what_meshes_of_meshio_lose_is_named():
    meshio = pytest.importorskip("meshio")
    vertices, faces = make_ball()
    halves = [faces[:100], faces[100:]]
    region = [np.full(len(half), 3, np.int32) for half in halves]
    mesh = meshio.Mesh(vertices, [("triangle", half) for half in halves], cell_sets={"inlet": [np.arange(9), np.arange(0)]},
                       cell_data={"region_inside": region, "region_outside": [0 * part for part in region],
                                  "mixed": [np.ones(len(halves[0])), np.ones((len(halves[1]), 2))]})
    source = taken(mesh, {})
    assert (source.regions["labels"] == [3, 0]).all()
    reasons = dict(source.dropped)
    assert "different numbers of values" in reasons["mixed"] and "sets" in reasons["inlet"]


def test_meshes_of_a_stage_of_usd_keep_their_regions_too(tmp_path):
    pytest.importorskip("pxr")
    for name, mesh in (("a", ball_with(1, "bone")), ("b", ball_with(1, "skin", at=3)), ("c", isoshell.Mesh(*make_ball()))):
        isoshell.usd.write(tmp_path / f"{name}.usda", isoshell.remesh(mesh, **SMALL))
    for names, lost in (("ab", False), ("abc", True)):
        prims = "".join(f'def "{name}" (references = @{name}.usda@) {{}}\n' for name in names)
        (tmp_path / "all.usda").write_text(f"#usda 1.0\n{prims}")
        if lost:
            with pytest.warns(isoshell.RunWarning, match="all.usda: the regions of 2 of 3 meshes are left out"):
                assert isoshell.usd.read(tmp_path / "all.usda").regions is None
            continue
        regions = isoshell.usd.read(tmp_path / "all.usda").regions
        assert regions["names"] == {1: "bone", 2: "skin"}
        assert np.unique(regions["labels"], axis=0).tolist() == [[1, 0], [2, 0]]
