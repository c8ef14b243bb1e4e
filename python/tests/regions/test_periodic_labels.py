"""Volumes of labels that go on with their other side."""

import numpy as np
import pytest

import isoshell
from isoshell import Labels


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
