"""Results can be copied, pickled and sent to other processes, and everything says how large it is."""

import copy
import multiprocessing
import pickle

import isoshell
import numpy as np
import pytest
from conftest import make_ball

SMALL = {"vertices": 100, "resolution": 32}


@pytest.fixture(scope="module")
def made():
    vertices, faces = make_ball()
    mesh = isoshell.Mesh(vertices, faces, of_vertices={"heat": vertices[:, 2].astype(np.float32)},
                         of_faces={"material": np.arange(len(faces)) // (len(faces) // 2 + 1)},
                         labels={"material": ["wood", "iron"]})
    return isoshell.remesh(mesh, stats=True, **SMALL)


def made_of_number(number):
    vertices, faces = make_ball()
    return isoshell.remesh((vertices * (1, 1, 1 + number), faces), **SMALL)


def check_same(result, other, tmp_path):
    assert other.digest == result.digest and other.report == result.report and other.labels == result.labels
    assert other.domains == result.domains and other.regions["names"] == result.regions["names"]
    for of in ("attributes", "features"):
        for name, values in getattr(result, of).items():
            assert np.array_equal(getattr(other, of)[name], values), name
            assert getattr(other, of)[name].dtype == values.dtype
    assert np.array_equal(other.regions["labels"], result.regions["labels"])
    for name, each in (("result", result), ("other", other)):
        each.save(tmp_path / f"{name}.ply", overwrite=True)
    assert (tmp_path / "other.ply").read_bytes() == (tmp_path / "result.ply").read_bytes()


@pytest.mark.parametrize("way", ["copy", "deepcopy", *(f"protocol {n}" for n in range(2, pickle.HIGHEST_PROTOCOL + 1))])
def test_a_copy_is_the_same_result(made, tmp_path, way):
    made.attributes
    if way.startswith("protocol"):
        other = pickle.loads(pickle.dumps(made, int(way.split()[1])))
    else:
        other = getattr(copy, way)(made)
    check_same(made, other, tmp_path)
    assert isoshell.remesh(other, **SMALL).digest == isoshell.remesh(made, **SMALL).digest


def test_a_result_with_regions_is_the_same_when_it_is_pickled(tmp_path):
    labels = np.zeros((10, 8, 8), np.uint8)
    labels[2:5, 2:6, 2:6], labels[5:8, 2:6, 2:6] = 3, 7
    result = isoshell.remesh(isoshell.Labels(labels, names={3: "tibia"}), vertices=150)
    other = pickle.loads(pickle.dumps(result))
    check_same(result, other, tmp_path)
    assert np.array_equal(other.region(3).vertices, result.region(3).vertices)
    assert isoshell.remesh(other, vertices=100).digest == isoshell.remesh(result, vertices=100).digest


def test_a_result_of_a_file_keeps_where_it_was_read(tmp_path, nefertiti):
    result = isoshell.remesh(nefertiti, **SMALL)
    check_same(result, pickle.loads(pickle.dumps(result)), tmp_path)


def test_results_come_from_other_processes():
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        made = pool.map(made_of_number, range(3))
    assert [result.digest for result in made] == [made_of_number(n).digest for n in range(3)]


def test_an_error_keeps_its_result(made):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(made, require="genus=3", **SMALL)
    other = pickle.loads(pickle.dumps(caught.value))
    assert other.result.digest == caught.value.result.digest
    assert (str(other), other.code, other.stage) == (str(caught.value), caught.value.code, caught.value.stage)


@pytest.mark.parametrize("state", [(), (1, 2, 3, 4), ((b"", b"", b"", [], (), (), ()), "{}", [], []),
                                   ((b"", b"\0" * 12, b"", [], ([], [], ""), (b"", b"", b""),
                                     (b"", 0, False, 0.0, b"", b"", [])), "{}", [], [])])
def test_what_is_no_pickled_result_is_refused(made, state):
    with pytest.raises(isoshell.Error, match="no pickled isoshell.Result"):
        type(made._made).__new__(type(made._made)).__setstate__(state)


def test_everything_says_how_large_it_is(made):
    vertices, faces = make_ball()
    assert repr(made) == (f"<isoshell.Result: 100 vertices, {len(made.faces)} faces, attributes "
                          f"{', '.join(made.attributes)}>")
    assert repr(isoshell.Mesh(vertices, faces, of_vertices={"heat": vertices[:, 0]})) == (
        f"<isoshell.Mesh: {len(vertices)} vertices, {len(faces)} faces, attributes heat>")
    assert repr(isoshell.Points(vertices, normals=vertices)) == f"<isoshell.Points: {len(vertices)} points, normals>"
    assert repr(isoshell.Volume(np.zeros((3, 4, 5), np.float32), spacing=0.5)) == (
        "<isoshell.Volume: 3 x 4 x 5 float32, spacing 0.5, origin 0.0>")
    assert repr(isoshell.Labels(np.zeros((3, 4, 5), np.uint8), names={1: "a"})) == (
        "<isoshell.Labels: 3 x 4 x 5 uint8, 1 names>")
    assert "2 regions" in repr(isoshell.Mesh(vertices, faces, regions={"labels": [[1, 0], [2, 0]]}))
    for broken in (isoshell.Mesh(None, 7), isoshell.Points(None), isoshell.Volume("a"), isoshell.Labels(None)):
        assert repr(broken).startswith("<isoshell.")
