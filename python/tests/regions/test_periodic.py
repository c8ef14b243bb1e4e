"""Volumes that go on with their other side."""

import numpy as np
import pytest

import isoshell
from isoshell import Labels


def waves(n):
    """Half of a cell is below 0, and many values are 0 in lattice points."""
    x, y, z = np.meshgrid(*[2 * np.pi * np.arange(n) / n] * 3, indexing="ij")
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)


def triangles_at(made, axis, end):
    faces = made.faces[(made.vertices[made.faces][:, :, axis] == end).all(1)]
    return {frozenset(map(tuple, np.delete(corners, axis, 1))) for corners in made.vertices[faces]}


@pytest.mark.parametrize("periodic, vertices", [("x,y,z", 3000), ("x,z", 800)])
def test_opposite_sides_of_a_periodic_field_have_the_same_triangles(periodic, vertices):
    made = isoshell.remesh(isoshell.Volume(waves(24), spacing=0.5, origin=(1, 2, 3), periodic=periodic), vertices=vertices)
    assert len(made.vertices) == vertices and made.report["quality"]["theta_min_deg"] > 5
    low, high = made.vertices.min(axis=0), made.vertices.max(axis=0)
    assert np.allclose(high - low, [12 if axis in periodic else 11.5 for axis in "xyz"], atol=1e-9)
    for axis, name in enumerate("xyz"):
        if name in periodic:
            sides = [triangles_at(made, axis, end[axis]) for end in (low, high)]
            assert sides[0] and sides[0] == sides[1]
    region = made.report["regions"]["regions"][0]
    assert region["label"] == 1 and region["closed"]
    if periodic == "x,y,z":
        assert region["volume"] == pytest.approx(12**3 / 2, rel=1e-3)


def test_a_periodic_field_without_two_sides_of_samples_is_refused():
    holed = waves(8)
    holed[4, 4, 4] = np.nan
    for values, how, message in ((waves(8), {"sides": "cell"}, "is closed at its samples"),
                                 (holed, {}, "values that are numbers all along its surface"),
                                 (waves(8)[:, :1], {}, "two values or more along each axis"),
                                 (waves(8), {"spacing": (1, 1, 1.3)}, "whole multiples of the shortest one"),
                                 (waves(8), {"periodic": "w"}, "periodic is")):
        with pytest.raises(isoshell.Error, match=message):
            isoshell.remesh(isoshell.Volume(values, **{"periodic": "x", **how}), iso=0, vertices=300)
    unsigned = np.abs(np.linalg.norm(np.mgrid[:24, :24, :24] - 11.5, axis=0) - 7)
    for values, how, message in ((unsigned, {}, "values of both signs"),
                                 (waves(8), {"boundary": "keep"}, "is closed at its samples")):
        with pytest.raises(isoshell.Error, match=message):
            isoshell.remesh(isoshell.Volume(values, periodic="x"), vertices=300, **how)


def test_opposite_sides_of_periodic_labels_are_translated(tmp_path):
    labels = np.random.default_rng(5).integers(1, 4, (5, 4, 3)).repeat(4, 0).repeat(4, 1).repeat(4, 2)
    made = isoshell.remesh(Labels(labels, spacing=(0.3, 0.3, 0.6), origin=(7, 8, 9), periodic="x,z"), vertices=2000)
    for axis, period in ((0, 0.3 * labels.shape[0]), (2, 0.6 * labels.shape[2])):
        along = made.vertices[:, axis]
        assert along.max() - along.min() == pytest.approx(period, abs=1e-9)
        low, high = ({tuple(np.delete(p, axis)) for p in made.vertices[along == end]} for end in (along.min(), along.max()))
        assert low == high
    for periodic in ("w", 3, ["x", "a"], None):
        with pytest.raises(isoshell.Error, match="periodic is"):
            Labels(labels, periodic=periodic).save(tmp_path / "refused.vdb")
