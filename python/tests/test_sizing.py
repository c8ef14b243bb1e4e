"""Edge lengths from an array."""

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode

SPACING, ORIGIN = 0.2, -1.4
AXIS = ORIGIN + SPACING * np.arange(15)


def field(lengths):
    """Lengths as a function of z, on a lattice around the ball."""
    return isoshell.Volume(np.broadcast_to(lengths, (15, 15, 15)), SPACING, ORIGIN)


def edge_lengths(result):
    edges = np.unique(np.sort(result.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), 1), axis=0)
    ends = result.vertices[edges]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), ends.mean(1)


def test_one_length_everywhere_is_an_edge_length(ball):
    even, asked = field(0.25), {"edge_length": 0.25}
    made = isoshell.remesh(ball, sizing=even, resolution=48)
    assert made.digest == isoshell.remesh(ball, resolution=48, **asked).digest
    assert isoshell.Stages(ball, sizing=even, resolution=48).triangulate().digest == made.digest


def test_edges_follow_the_array(ball):
    sizing = field(0.25 + 0.1 * AXIS)
    for options in ({}, {"vertices": 600}):
        lengths, middles = edge_lengths(isoshell.remesh(ball, sizing=sizing, gradation=1.5, **options))
        ratio = lengths[middles[:, 2] > 0.8].mean() / lengths[middles[:, 2] < -0.8].mean()
        assert ratio == pytest.approx(0.34 / 0.16, rel=0.1)


@pytest.mark.parametrize("sizing, code, words", [
    (field(np.where(AXIS > 0, 0.1, -0.1)), ErrorCode.UNREADABLE_INPUT, "is no edge length"),
    (field(np.nan), ErrorCode.UNREADABLE_INPUT, "no active voxels"),
    (isoshell.Volume(np.ones((2, 2, 2)), spacing=0), ErrorCode.USAGE, "spacing must be above 0"),
    (isoshell.Volume(np.ones((2, 2))), ErrorCode.USAGE, "sizing"),
])
def test_an_array_that_holds_no_lengths_is_refused(ball, sizing, code, words):
    with pytest.raises(isoshell.Error, match=words) as refused:
        isoshell.remesh(ball, sizing=sizing)
    assert refused.value.code == code
