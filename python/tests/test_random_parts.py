"""Parts that no one has tuned the library for: each a closed manifold without intersections, no crease gone unsaid."""

import sys

import isoshell
import numpy as np
import pytest
from conftest import SOURCE

pytest.importorskip("manifold3d")
pytest.importorskip("trimesh")
sys.path.append(str(SOURCE / "bench"))

COUNT, SEED, VERTICES = 20, 2026, 1000
LEAST_LENGTH = 0.98  # of all curves: edges are chords of them, and where these are round they lose up to .6 % by that

pytestmark = pytest.mark.filterwarnings("ignore::isoshell.RunWarning")


def curve_length(result):
    """Of the edges of the result that are on curves of its source."""
    ends = result.vertices[result.features["curve_edges"]]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    import csg_shapes

    folder = tmp_path_factory.mktemp("parts")
    csg_shapes.write_parts(folder, COUNT, SEED)
    return sorted(folder.iterdir())


@pytest.mark.parametrize("number", range(COUNT))
def test_a_random_part_is_valid_and_says_which_creases_it_lost(parts, number):
    result = isoshell.remesh(parts[number], vertices=VERTICES, threads=1)
    topology, features = result.report["topology"], result.report["features"]
    assert topology["closed"] and topology["manifold"] and topology["self_intersections"] == 0
    assert features["curves"] > 0
    assert curve_length(result) + features["lost_length"] >= LEAST_LENGTH * features["length"]
