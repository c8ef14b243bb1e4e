"""A drop that falls into a pool: level sets whose parts join and part, and whose rim is sharp until then."""

import sys

import isoshell
import pytest
from conftest import SOURCE

sys.path.append(str(SOURCE / "bench"))

VOXELS, VERTICES, FRAMES = 64, 1500, range(5, 20)

pytestmark = pytest.mark.filterwarnings("ignore::isoshell.RunWarning")


@pytest.fixture(scope="module")
def made():
    import splash

    def source(frame):
        distance, velocity, low, spacing = splash.frame_of(frame, VOXELS)
        return isoshell.Volume(distance, spacing, low, velocity)

    return list(isoshell.remesh_sequence(map(source, FRAMES), iso=0, vertices=VERTICES))


def test_every_frame_of_a_splash_begins_with_the_one_before(made):
    coherence = [result.report["coherence"] for result in made[1:]]
    assert all(frame["began_warm"] for frame in coherence)
    assert min(frame["kept_edges_pct"] for frame in coherence) > 90


def test_every_frame_of_a_splash_is_a_good_mesh(made):
    for result in made:
        topology = result.report["topology"]
        assert topology["closed"] and topology["manifold"] and topology["self_intersections"] == 0
        assert result.report["quality"]["theta_min_deg"] > 25


def test_parts_of_a_splash_join_and_part(made):
    parts = [result.report["topology"]["components"] for result in made]
    assert parts[0] == 2 and 1 in parts and max(parts) > 4


def test_creases_stay_while_they_are_the_rule_and_do_not_come_and_go(made):
    has_creases = [result.report["features"]["curves"] > 0 for result in made]
    assert has_creases[0] and not has_creases[-1]
    assert has_creases == sorted(has_creases, reverse=True)
