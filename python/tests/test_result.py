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


def test_names_of_the_solids_of_a_text_stl_are_labels_of_groups(tmp_path, box):
    vertices, faces = box
    path, text = tmp_path / "box.stl", ""
    for name, sides in {"lid": faces[:1], "gr\udcfc\udcdf": faces[1:]}.items():  # one that is not UTF-8
        text += f"solid {name}\n"
        for a, b, c, d in sides:
            for corners in (a, b, c), (a, c, d):
                rows = "".join("vertex {} {} {}\n".format(*vertices[i]) for i in corners)
                text += f"facet normal 0 0 0\nouter loop\n{rows}endloop\nendfacet\n"
        text += f"endsolid {name}\n"
    path.write_text(text, "utf-8", "surrogateescape")
    result = isoshell.remesh(path, vertices=300, resolution=32)
    assert result.labels == {"group": ["lid", "gr\udcfc\udcdf"]}
    assert set(result.attributes["group"]) == {0, 1}


def test_attributes_given_as_arrays_are_those_of_a_file_that_has_them(tmp_path, ball):
    vertices, faces = ball
    heat = np.arange(len(vertices), dtype=np.float32)
    part = (np.arange(len(faces)) % 5).astype(np.int16)
    head = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {c}" for c in "xyz"),
            "property float heat", f"element face {len(faces)}", "property list uchar int vertex_indices",
            "property short part", "end_header"]
    rows = [f"{x!r} {y!r} {z!r} {h}" for (x, y, z), h in zip(vertices.tolist(), heat)]
    rows += [f"3 {a} {b} {c} {p}" for (a, b, c), p in zip(faces.tolist(), part)]
    (tmp_path / "ball.ply").write_text("\n".join(head + rows) + "\n")
    mesh = isoshell.Mesh(vertices, faces, of_vertices={"heat": heat}, of_faces={"part": part})
    ours, theirs = isoshell.remesh(mesh, **SMALL), isoshell.remesh(tmp_path / "ball.ply", **SMALL)
    assert ours.digest == theirs.digest and ours.domains == theirs.domains
    for name in ("heat", "part"):
        assert ours.attributes[name].dtype == theirs.attributes[name].dtype
        assert np.array_equal(ours.attributes[name], theirs.attributes[name])
    assert "heat" not in isoshell.remesh(mesh, attributes="part", **SMALL).attributes


def test_a_result_as_a_source_passes_its_attributes_on(colored):
    again = isoshell.remesh(colored, vertices=200, resolution=40)
    assert {name: again.domains[name] for name in ("color", "heat", "uv", "part")} == {
        name: colored.domains[name] for name in ("color", "heat", "uv", "part")}
    assert np.allclose(again.attributes["heat"], again.vertices[:, 2], atol=1e-2)


def test_labels_given_as_arrays_reach_the_result(box):
    vertices, quads = box
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    mesh = isoshell.Mesh(vertices, faces, of_faces={"material": np.repeat([0, 1, 0, 1, 0, -1], 2)},
                         labels={"material": ["wood", "iron"]})
    result = isoshell.remesh(mesh, vertices=200, resolution=32)
    assert result.labels["material"] == ["wood", "iron"]
    assert set(np.unique(result.attributes["material"])) == {-1, 0, 1}


def test_there_may_be_several_sets_of_texture_coordinates(box):
    vertices, quads = box
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    uv = vertices[faces][:, :, :2]
    result = isoshell.remesh(isoshell.Mesh(vertices, faces, of_corners={"uv": uv, "uv1": 1 - uv}), vertices=200)
    assert np.allclose(result.attributes["uv"], result.vertices[result.faces][:, :, :2], atol=1e-3)
    assert np.allclose(result.attributes["uv"], 1 - result.attributes["uv1"], atol=1e-6)


@pytest.mark.parametrize("attributes", [
    {"of_vertices": {"heat": np.zeros(7)}},
    {"of_vertices": {"heat": np.zeros((8, 2))}},
    {"of_vertices": {"heat": np.zeros((8, 1, 1))}},
    {"of_vertices": {"heat": "warm"}},
    {"of_vertices": {"heat": np.full(8, 2**40)}},
    {"of_vertices": {"heat": np.float32(1)}},
    {"of_vertices": {"uv": np.zeros((8, 2))}},
    {"of_vertices": {"color": np.zeros((8, 2))}},
    {"of_faces": {"part": np.zeros(3)}},
    {"of_faces": {"part": np.zeros(0)}},
    {"of_faces": {"material": np.full(12, 7)}, "labels": {"material": ["wood"]}},
    {"of_corners": {"uv": np.zeros((12, 2))}},
    {"of_corners": {"uv": np.zeros((12, 3, 3))}},
    {"of_corners": {"uv": np.zeros((11, 3, 2))}},
    {"of_corners": {"uv1": np.zeros((12, 3, 3))}},
    {"of_corners": {"uvw": np.zeros((12, 3, 2))}},
    {"of_corners": {"heat": np.zeros((12, 3, 1))}},
])
def test_attributes_that_do_not_fit_are_refused_by_name(box, attributes):
    vertices, quads = box
    faces = quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    name = next(name for key, values in attributes.items() if key != "labels" for name in values)
    with pytest.raises(isoshell.Error, match=f"'{name}'"):
        isoshell.remesh(isoshell.Mesh(vertices, faces, **attributes), **SMALL)


def far(ball):
    return np.asarray(ball[0]) + (500_000, 5_400_000, 300), ball[1]


def test_a_far_result_is_saved_less_an_offset_that_a_warning_names(tmp_path, ball):
    result = isoshell.remesh(far(ball), vertices=1000, device="cpu")
    for recenter in ("auto", (500_000, 5_400_000, 300), np.array([500_000, 5_400_000, 300])):
        with pytest.warns(isoshell.RunWarning, match="500000 5400000 300 is subtracted from the positions"):
            result.save(tmp_path / "a.stl", overwrite=True, recenter=recenter)
        isoshell.mesh_info(tmp_path / "a.stl", require="closed,manifold,no-self-intersections")
    with pytest.raises(isoshell.Error, match="recenter"):
        result.save(tmp_path / "b.stl", recenter=(1, 2))


def test_a_file_whose_numbers_do_not_hold_the_result_is_refused(tmp_path, ball):
    result = isoshell.remesh((np.asarray(ball[0]) + (1e8, 0, 0), ball[1]), vertices=1000, device="cpu")
    with pytest.raises(isoshell.Error, match="32-bit floats do not hold the mesh") as refused:
        result.save(tmp_path / "a.stl")
    assert refused.value.code == isoshell.ErrorCode.UNWRITABLE_OUTPUT
    assert not (tmp_path / "a.stl").exists()
    with pytest.raises(isoshell.Error, match="its numbers are too coarse") as missed:
        isoshell.remesh((np.asarray(ball[0]) + (1e8, 0, 0), ball[1]), vertices=1000, device="cpu",
                        output=tmp_path / "b.stl")
    assert len(missed.value.result.vertices) == 1000


def test_the_number_of_vertices_is_a_requirement(ball):
    assert isoshell.remesh(ball, vertices=300, require="count", device="cpu").report["counts"]["asked"] == 300
    with pytest.raises(isoshell.Error, match="require count compares"):
        isoshell.remesh(ball, edge_length=1, require="count", device="cpu")
