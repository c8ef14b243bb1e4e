"""Tetrahedra in regions, by other programs."""

from __future__ import annotations

import isoshell
import numpy as np
import pytest
from conftest import write_obj

meshio = pytest.importorskip("meshio")
pytest.importorskip("tetgen", reason="needs tetgen: pip install tetgen")
MESHERS = ["tetgen", pytest.param("gmsh", marks=pytest.mark.filterwarnings("ignore"))]


@pytest.fixture(scope="module")
def grains() -> isoshell.Result:
    """Two that touch, a region and a hollow within them, and a label of two pieces, one of them in the hollow."""
    array = np.zeros((24, 20, 20), np.int32)
    array[2:10, 2:18, 2:18], array[10:18, 2:18, 2:18] = 1, 2
    array[12:16, 6:14, 6:14], array[3:9, 4:14, 4:14] = 3, 0
    array[5:7, 7:11, 7:11] = array[20:23, 4:16, 4:16] = 4
    return isoshell.remesh(isoshell.Labels(array, names={2: "steel"}), vertices=3000, device="cpu")


@pytest.mark.parametrize("mesher", MESHERS)
def test_every_region_is_full_with_its_walls_as_they_are(grains, mesher):
    if mesher == "gmsh":
        pytest.importorskip("gmsh")
    filled = grains.fill(mesher)
    count = len(grains.vertices)
    assert np.array_equal(filled.vertices[:count], grains.vertices)
    for counted in grains.report["regions"]["regions"]:
        assert filled.volume(counted["label"]) == pytest.approx(counted["volume"], rel=1e-6)
    corners = filled.vertices[filled.tetrahedra]
    assert (np.linalg.det(corners[:, 1:] - corners[:, :1]) > 0).all()
    sides = np.sort(np.concatenate([filled.tetrahedra[:, [*{0, 1, 2, 3} - {i}]] for i in range(4)]), axis=1)
    of_region = np.tile(filled.regions, 4)
    outer: dict = {}
    for side, label in zip(map(tuple, sides.tolist()), of_region.tolist()):
        outer.setdefault(side, []).append(label)
    walls = {tuple(sorted(face)): sorted({*pair} - {0})
             for face, pair in zip(grains.faces.tolist(), grains.regions["labels"].tolist())}
    for side, labels in outer.items():
        if len(labels) == 1 or labels[0] != labels[1]:
            assert walls[side] == sorted(labels)  # what is the side of one tetrahedron alone, or of two regions
    assert len(walls) == sum(len(labels) == 1 or labels[0] != labels[1] for labels in outer.values())


def test_files_have_the_regions_with_their_names(grains, tmp_path):
    filled = grains.fill()
    assert filled.to_meshio().field_data["steel"].tolist() == [2, 3]
    for ending in ("msh", "vtu", "inp"):
        filled.save(tmp_path / f"full.{ending}")
        with pytest.raises(isoshell.Error, match="full"):
            filled.save(tmp_path / f"full.{ending}")
        read = meshio.read(tmp_path / f"full.{ending}")
        assert np.allclose(read.points, filled.vertices) and len(read.cells_dict["tetra"]) == len(filled.tetrahedra)
        if ending != "inp":
            assert np.array_equal(read.cell_data_dict["gmsh:physical" if ending == "msh" else "region"]["tetra"],
                                  filled.regions)
    assert "ELSET=steel" in (tmp_path / "full.inp").read_text() and "ELSET=region_1" in (tmp_path / "full.inp").read_text()
    with pytest.raises(isoshell.Error, match=r"\.msh, \.vtu, \.inp"):
        filled.save(tmp_path / "full.stl")


def test_a_closed_mesh_without_regions_is_filled_and_an_open_one_is_refused(ball):
    closed = isoshell.remesh(ball, vertices=300)
    a, b, c = (closed.vertices[closed.faces[:, i]] for i in range(3))
    assert closed.fill().volume(1) == pytest.approx(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)
    x, _, z = np.meshgrid(*[np.arange(12.0)] * 3, indexing="ij")
    terrain = isoshell.remesh(isoshell.Volume(z - 5.3 - np.sin(x / 3)), boundary="keep", vertices=200)
    with pytest.raises(isoshell.Error, match="is open, and encloses nothing"):
        terrain.fill()
    with pytest.raises(isoshell.Error, match="mesher is 'netgen'"):
        closed.fill("netgen")


@pytest.mark.filterwarnings("ignore")
def test_gmsh_fills_what_is_as_thin_as_a_twentieth_of_a_degree():
    pytest.importorskip("gmsh")
    corners = [(0, 0, 0), (10, 0, 0), (10, 0, .0087), (0, 8, 0), (10, 8, 0), (10, 8, .0087)]
    faces = [(0, 1, 2), (3, 5, 4), (0, 4, 1), (0, 3, 4), (1, 5, 2), (1, 4, 5), (0, 2, 5), (0, 5, 3)]
    wedge = isoshell.remesh(isoshell.Mesh(np.array(corners), np.array(faces)), vertices=50, device="cpu")
    assert wedge.report["quality"]["dihedral_min_deg"] < .1
    assert wedge.fill("gmsh").volume(1) == pytest.approx(10 * 8 * .0087 / 2, rel=.1)


def test_the_command_fills_what_it_writes(tmp_path, ball):
    from isoshell.__main__ import remesh

    write_obj(tmp_path / "ball.obj", *ball)
    words = [str(tmp_path / "ball.obj"), str(tmp_path / "out.ply"), "--vertices", "200", "--quiet"]
    assert remesh([*words, "--fill", str(tmp_path / "full.vtu")]) == 0
    assert len(meshio.read(tmp_path / "full.vtu").cells_dict["tetra"]) > 300
    assert remesh([*words, "--force", f"--fill={tmp_path / 'full.stl'}"]) == 2
    by_gmsh = ["--fill", str(tmp_path / "gmsh.vtu"), "--fill-mesher", "gmsh"]
    assert remesh([*words, "--force", *by_gmsh]) == 0 and (tmp_path / "gmsh.vtu").exists()
    for refused in (["--fill-mesher", "gmsh"], [*by_gmsh[:3], "netgen"]):
        assert remesh([*words, "--force", *refused]) == 2
    assert remesh([*words, "--force", "--fill", str(tmp_path / "full.vtu")]) == 0
    assert remesh([*words, "--force", "--fill", str(tmp_path / "other.vtu"), "--dry-run"]) == 0
    assert not (tmp_path / "other.vtu").exists()
    same = [words[0], str(tmp_path / "same.vtu"), *words[2:], "--fill", str(tmp_path / "same.vtu")]
    assert remesh(same) == 2 and not (tmp_path / "same.vtu").exists()
