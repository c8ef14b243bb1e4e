"""What a mask says has no value has none."""

import isoshell
import numpy as np
import pytest
from conftest import make_ball
from isoshell._exchange._take import Taker
from test_sources import ball_values

SMALL = {"vertices": 100, "resolution": 32}


def masked(values, *places):
    mask = np.zeros(np.shape(values), bool)
    for place in places:
        mask[place] = True
    return np.ma.array(values, mask=mask)


def digest(source, **options):
    return isoshell.remesh(source, **SMALL, **options).digest


def test_a_mask_of_nothing_changes_nothing(ball):
    assert digest((np.ma.array(ball[0]), np.ma.array(ball[1]))) == digest(ball)


@pytest.mark.parametrize("place", [(3, 1), 3])
def test_points_that_are_masked_are_left_out_with_their_normals(ball, place):
    points = ball[0].copy()
    points[3] = 1e6
    kept = np.delete(ball[0], 3, axis=0)
    assert digest(isoshell.Points(masked(points, place), normals=ball[0])) == digest(isoshell.Points(kept, normals=kept))
    assert digest(isoshell.Points(masked(points, place))) == digest(isoshell.Points(kept))
    assert digest(isoshell.Points(ball[0], masked(ball[0], place))) == digest(isoshell.Points(kept, kept))


def test_vertices_and_faces_that_are_masked_are_refused_by_their_place(ball):
    for source, words in (((masked(ball[0], (5, 1)), ball[1]), r"vertices\[5, 1\] is masked"),
                          ((ball[0], masked(ball[1], (7, 2))), r"faces\[7, 2\] is masked"),
                          ((list(masked(ball[0], (5, 1))), ball[1]), r"vertices\[5, 1\] is masked"),
                          (isoshell.Mesh(masked(ball[0], (5, 1)), ball[1]), r"vertices\[5, 1\] is masked")):
        with pytest.raises(isoshell.Error, match=words) as caught:
            isoshell.remesh(source, **SMALL)
        assert caught.value.code == isoshell.ErrorCode.USAGE and "filled" in str(caught.value)


def test_masked_numbers_of_an_attribute_are_none_and_masked_whole_numbers_are_refused(ball):
    heat = masked(ball[0][:, 2], slice(0, 40))
    made = isoshell.remesh(isoshell.Mesh(*ball, of_vertices={"heat": heat}), **SMALL).attributes["heat"]
    assert np.isnan(made).any() and np.nanmax(np.abs(made)) <= 1.001
    with pytest.raises(isoshell.Error, match=r"'part' is masked at \[2\]"):
        isoshell.remesh(isoshell.Mesh(*ball, of_faces={"part": masked(np.arange(len(ball[1])), 2)}), **SMALL)


def test_masks_of_other_packages_are_those_of_a_mesh(ball):
    count = len(ball[0])
    taker = Taker("mesh", *ball)
    taker.add("heat", "vertex", masked(np.ones(count, np.float32), 2))
    assert np.isnan(taker.mesh.of_vertices["heat"][2]) and taker.mesh.of_vertices["heat"].dtype == np.float32
    for words, ask in ((r"'part' is masked at \[2\]", lambda: taker.add("part", "vertex", masked(np.arange(count), 2))),
                       (r"vertices\[5, 1\] is masked", lambda: Taker("mesh", masked(ball[0], (5, 1)), ball[1])),
                       (r"faces\[7, 2\] is masked", lambda: Taker("mesh", ball[0], masked(ball[1], (7, 2))))):
        with pytest.raises(isoshell.Error, match=words):
            ask()


def test_a_masked_voxel_of_true_and_false_is_outside():
    values, spacing, origin = ball_values()
    inside = values < 0
    hidden = np.zeros_like(inside)
    hidden[:15] = True
    half = isoshell.Volume(np.ma.array(inside, mask=hidden), spacing, origin)
    assert digest(half) == digest(isoshell.Volume(inside & ~hidden, spacing, origin))
    slices = isoshell.Volume([*half.values], spacing, origin)  # an array that masks some of its parts
    assert digest(slices) == digest(half)


def test_a_masked_volume_of_true_and_false_may_have_velocities():
    values, spacing, origin = ball_values()
    inside, hidden = values < 0, np.indices(values.shape)[0] < 15
    velocities = np.full((*values.shape, 3), 0.01)

    def moved(mask, vectors):
        frames = [isoshell.Volume(mask, spacing, origin, vectors)] * 2
        return [result.digest for result in isoshell.remesh_sequence(frames, **SMALL)]

    known = moved(inside & ~hidden, np.where(hidden[..., None], np.nan, velocities))
    partly = np.ma.array(velocities, mask=np.broadcast_to(hidden[..., None], velocities.shape))
    for mask in (np.ma.array(inside, mask=hidden), [*np.ma.array(inside, mask=hidden)]):
        assert moved(mask, partly) == known


def test_a_masked_value_of_a_volume_is_one_that_is_not_known():
    values, spacing, origin = ball_values()
    hidden = np.zeros(values.shape, bool)
    hidden[:, :, : values.shape[2] // 3] = True

    def made(some):
        with pytest.warns(isoshell.RunWarning, match="are not known, and its surface is open in"):
            return isoshell.remesh(isoshell.Volume(some, spacing, origin), boundary="keep", **SMALL)

    result = made(np.ma.array(values, mask=hidden))
    assert result.report["topology"]["boundary_loops"] == 1
    assert result.digest == made(np.where(hidden, np.nan, values)).digest


def test_a_masked_label_is_background():
    labels = np.zeros((12, 8, 8), np.int16)
    labels[2:6, 2:6, 2:6], labels[6:10, 2:6, 2:6] = 3, 7
    hidden = labels == 7
    made = isoshell.remesh(isoshell.Labels(np.ma.array(labels, mask=hidden)), vertices=200)
    assert {*made.regions["labels"].ravel().tolist()} == {0, 3}
    assert made.digest == isoshell.remesh(isoshell.Labels(np.where(hidden, 0, labels)), vertices=200).digest


def test_a_masked_length_says_nothing():
    vertices, faces = make_ball()
    lengths = np.where(vertices[:, 2] > 0, 0.2, -1)
    upper = np.ma.array(lengths, mask=lengths < 0)
    assert digest((vertices, faces), sizing=upper) == digest((vertices, faces), sizing=np.where(lengths < 0, np.nan, 0.2))
    grid = np.full((15, 15, 15), 0.2)
    grid[:, :, :7] = -1
    field = [isoshell.Volume(values, 0.2, -1.4) for values in (np.ma.masked_less(grid, 0), np.where(grid < 0, np.nan, grid))]
    assert digest((vertices, faces), sizing=field[0]) == digest((vertices, faces), sizing=field[1])
