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


def growing(ball):
    return 0.25 + 0.1 * ball[0][:, 2]


@pytest.mark.parametrize("way", ["array", "attribute", "quads", "result"])
def test_edges_follow_a_length_at_each_vertex(ball, box, way):
    mesh = isoshell.Mesh(*ball, of_vertices={"size": growing(ball)})
    source, sizing = {"array": (ball, growing(ball)), "attribute": (mesh, "size"), "result": (mesh, "size"),
                      "quads": (ball, growing(ball).tolist())}[way]
    if way == "quads":
        pairs = np.array([[a, b, c, c] for a, b, c in ball[1].tolist()])
        source = (ball[0], pairs)
    if way == "result":
        source = isoshell.remesh(isoshell.Mesh(*ball, of_vertices={"size": growing(ball)}), vertices=2000)
    for options in ({}, {"vertices": 600}):
        made = isoshell.remesh(source, sizing=sizing, gradation=1.5, **options)
        lengths, middles = edge_lengths(made)
        ratio = lengths[middles[:, 2] > 0.8].mean() / lengths[middles[:, 2] < -0.8].mean()
        assert ratio == pytest.approx(0.34 / 0.16, rel=0.1)


def test_one_length_at_every_vertex_is_an_edge_length(ball):
    made = isoshell.remesh(ball, sizing=np.full(len(ball[0]), 0.25), resolution=48)
    assert made.digest == isoshell.remesh(ball, resolution=48, edge_length=0.25).digest


def test_an_attribute_of_lengths_may_be_that_of_a_file_and_need_not_be_kept(tmp_path, ball):
    mesh = isoshell.Mesh(*ball, of_vertices={"size": growing(ball)})
    kept = isoshell.remesh(mesh, vertices=2000)
    kept.save(tmp_path / "ball.ply")
    from_file = isoshell.remesh(tmp_path / "ball.ply", sizing="size", vertices=500, attributes="none")
    assert "size" not in from_file.attributes
    assert from_file.report["sizing"]["max"] > 1.5 * from_file.report["sizing"]["min"]
    many = isoshell.remesh_many([tmp_path / "ball.ply"], sizing="size", vertices=500)
    assert next(many).digest == from_file.digest


@pytest.mark.parametrize("change, code, words", [
    (lambda l: l[:-1], ErrorCode.USAGE, "edge lengths for 266 vertices"),
    (lambda l: np.where(np.arange(len(l)) == 7, -1, l), ErrorCode.UNREADABLE_INPUT, r"sizing\[7\] is -1"),
    (lambda l: np.where(np.arange(len(l)) == 7, np.inf, l), ErrorCode.UNREADABLE_INPUT, r"sizing\[7\] is inf"),
    (lambda l: l * np.nan, ErrorCode.UNREADABLE_INPUT, "sizing has no edge length"),
    (lambda l: l.reshape(-1, 2), ErrorCode.USAGE, "one edge length for each vertex"),
    (lambda l: l.astype(complex), ErrorCode.USAGE, "sizing must be an array of numbers"),
    (lambda l: "size", ErrorCode.USAGE, "no .vdb file and no number of the vertices of .*: none"),
])
def test_lengths_that_do_not_fit_are_refused(ball, change, code, words):
    with pytest.raises(isoshell.Error, match=words) as caught:
        isoshell.remesh(ball, sizing=change(growing(ball)))
    assert caught.value.code == code


def test_an_array_of_lengths_is_for_meshes_in_memory(tmp_path, ball, nefertiti):
    for source in (nefertiti, isoshell.Points(ball[0])):
        with pytest.raises(isoshell.Error, match="for meshes in memory"):
            isoshell.remesh(source, sizing=growing(ball))
    with pytest.raises(isoshell.Error, match="name an attribute"):
        isoshell.remesh_many([ball], sizing=growing(ball))
