"""What a run gives back."""

import gc

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode

SMALL = {"vertices": 100, "resolution": 32}


@pytest.fixture(scope="module")
def result(ball):
    return isoshell.remesh(ball, **SMALL)


def test_vertices_and_faces_are_views_of_the_same_memory(result):
    assert result.vertices.shape == (100, 3) and result.vertices.dtype == np.float64
    assert result.faces.shape == (196, 3) and result.faces.dtype == np.int32
    for name in ("vertices", "faces"):
        first, second = getattr(result, name), getattr(result, name)
        assert np.shares_memory(first, second)
        assert first.flags.c_contiguous and not first.flags.owndata and not first.flags.writeable


def test_arrays_outlive_their_result(ball):
    made = isoshell.remesh(ball, **SMALL)
    vertices, faces = made.vertices, made.faces
    copies = vertices.copy(), faces.copy()
    del made
    gc.collect()
    for _ in range(3):
        isoshell.remesh(ball, **SMALL)
    assert np.array_equal(vertices, copies[0]) and np.array_equal(faces, copies[1])


def test_the_mesh_is_closed_and_its_report_says_so(result):
    edges = np.sort(result.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] == 2)
    assert result.report["topology"]["closed"] is True
    assert result.report["counts"]["vertices"] == 100
    assert result.report["distance"] is None
    assert "100 vertices" in repr(result)


def test_saved_files_are_those_of_the_run(tmp_path, ball):
    result = isoshell.remesh(ball, output=tmp_path / "run.ply", **SMALL)
    result.save(tmp_path / "saved.ply")
    assert (tmp_path / "saved.ply").read_bytes() == (tmp_path / "run.ply").read_bytes()
    with pytest.raises(isoshell.Error) as caught:
        result.save(tmp_path / "saved.ply")
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    result.save(tmp_path / "saved.ply", overwrite=True)
    for ending in ("obj", "stl", "off"):
        result.save(str(tmp_path / f"saved.{ending}"))
    with pytest.raises(isoshell.Error):
        result.save(tmp_path / "saved.doc")


PLY = """ply
format ascii 1.0
element vertex 8
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
property double heat
element face 6
property list uchar int vertex_indices
property list uchar float texcoord
property short part
end_header
"""


@pytest.fixture(scope="module")
def colored(tmp_path_factory, box):
    vertices, quads = box
    path = tmp_path_factory.mktemp("colored") / "box.ply"
    rows = [f"{x} {y} {z} {int(255 * x)} {int(255 * y)} 7 {z}" for x, y, z in vertices.tolist()]
    uv = "8 0 0 0 1 1 1 1 0"
    rows += [f"4 {' '.join(map(str, quad))} {uv} {i}" for i, quad in enumerate(quads.tolist())]
    path.write_text(PLY + "\n".join(rows) + "\n")
    return isoshell.remesh(path, vertices=300, resolution=40)


def test_attributes_are_arrays_of_the_type_that_the_file_had(colored):
    attributes, faces = colored.attributes, len(colored.faces)
    assert attributes["color"].dtype == np.uint8 and attributes["color"].shape == (300, 3)
    assert attributes["heat"].dtype == np.float64 and attributes["heat"].shape == (300,)
    assert attributes["uv"].shape == (faces, 3, 2) and attributes["uv"].dtype.kind == "f"
    assert attributes["part"].shape == (faces,) and attributes["part"].dtype == np.int16
    assert {name: colored.domains[name] for name in ("color", "heat", "uv", "part")} == {
        "color": "vertex", "heat": "vertex", "uv": "corner", "part": "face"}
    assert np.allclose(attributes["heat"], colored.vertices[:, 2], atol=1e-3)
    assert np.allclose(attributes["color"][:, 0], 255 * colored.vertices[:, 0], atol=1)


def test_features_name_the_patches_curves_and_corners(colored):
    features = colored.features
    assert len(np.unique(features["patch"])) == 6 and len(features["patch"]) == len(colored.faces)
    assert len(np.unique(features["curve"])) == 12 and features["curve_edges"].shape == (len(features["curve"]), 2)
    assert len(features["corners"]) == 8
    corners = colored.vertices[features["corners"]]
    assert np.allclose(corners, np.round(corners), atol=1e-6)


def test_colours_reach_trimesh(colored):
    pytest.importorskip("trimesh")
    assert np.array_equal(colored.to_trimesh().visual.vertex_colors[:, :3], colored.attributes["color"])


def test_names_of_materials_are_labels(tmp_path, box):
    vertices, quads = box
    rows = ["v {} {} {}".format(*v) for v in vertices.tolist()]
    for i, quad in enumerate(quads.tolist()):
        rows += [f"usemtl {'wood' if i < 3 else 'iron'}", "f " + " ".join(str(c + 1) for c in quad)]
    (tmp_path / "box.obj").write_text("\n".join(rows) + "\n")
    result = isoshell.remesh(tmp_path / "box.obj", vertices=200, resolution=32)
    labels, numbers = result.labels["material"], result.attributes["material"]
    assert sorted(labels) == ["iron", "wood"] and len(numbers) == len(result.faces)
    assert {labels[n] for n in np.unique(numbers)} == {"iron", "wood"}
