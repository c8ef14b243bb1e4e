"""The module makes the mesh that the command makes."""

import json

import isoshell
import numpy as np
import pytest
from conftest import make_ball, write_obj

SMALL = {"vertices": 200, "resolution": 48}
SMALL_WORDS = ("--vertices", 200, "--resolution", 48)


def digest_of_command(command, folder, source, *words):
    done = command(source, folder / "out.ply", "--stats", folder / "out.json", "--force", *SMALL_WORDS, *words)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "out.json").read_text())["digests"]["mesh"]


def test_a_path_gives_the_mesh_of_the_command(command, tmp_path, nefertiti):
    assert isoshell.remesh(nefertiti, **SMALL).digest == digest_of_command(command, tmp_path, nefertiti)


def test_arrays_give_the_mesh_of_the_file_that_holds_them(command, tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    assert isoshell.remesh(ball, **SMALL).digest == digest_of_command(command, tmp_path, source)


def test_quads_give_the_mesh_of_the_file_that_holds_them(command, tmp_path, box):
    source = write_obj(tmp_path / "box.obj", *box)
    assert isoshell.remesh(box, **SMALL).digest == digest_of_command(command, tmp_path, source)


@pytest.mark.parametrize("options, words", [
    ({"features": 30}, ["--features", 30]),
    ({"features": "off"}, ["--features", "off"]),
    ({"seed": 7}, ["--seed", 7]),
    ({"fit": "surface"}, ["--fit", "surface"]),
    ({"uniform_area": True}, ["--uniform-area"]),
    ({"close_gaps": "4vox"}, ["--close-gaps", "4vox"]),
    ({"adaptivity": np.float32(0.5)}, ["--adaptivity", 0.5]),
    ({"method": "shell", "features": "off"}, ["--method", "shell", "--features", "off"]),
    ({"iterations": np.int64(3), "tolerance": 1e-3}, ["--iterations", 3, "--tolerance", 1e-3]),
])
def test_an_option_means_what_it_means_to_the_command(command, tmp_path, box, options, words):
    source = write_obj(tmp_path / "box.obj", *box)
    assert isoshell.remesh(box, **SMALL, **options).digest == digest_of_command(command, tmp_path, source, *words)


def test_defaults_are_those_of_the_command(tmp_path, ball, command):
    source = write_obj(tmp_path / "ball.obj", *ball)
    done = command(source, tmp_path / "out.ply", "--stats", tmp_path / "out.json")
    assert done.returncode == 0, done.stderr
    written = json.loads((tmp_path / "out.json").read_text())
    result = isoshell.remesh(ball)
    assert result.report["options"] == written["options"]
    assert result.digest == written["digests"]["mesh"]


def test_a_surface_far_away_has_the_same_faces(ball):
    # Steps of double precision at 10^6 are 2^-33, so a ball on a lattice of 2^-20 is there exactly.
    vertices = np.round(ball[0] * 2**20) / 2**20
    near = isoshell.remesh((vertices, ball[1]), **SMALL)
    far = isoshell.remesh((vertices + 2.0**20, ball[1]), **SMALL)
    assert np.array_equal(near.faces, far.faces)
    assert np.allclose(far.vertices - 2.0**20, near.vertices, atol=1e-8)


def test_report_is_what_the_command_writes(command, tmp_path, nefertiti):
    result = isoshell.remesh(nefertiti, stats=True, **SMALL)
    digest_of_command(command, tmp_path, nefertiti)
    written = json.loads((tmp_path / "out.json").read_text())
    for key in written:
        if key not in ("output", "timings_ms", "memory_bytes"):
            assert result.report[key] == written[key], key
    assert set(result.report) == set(written)


def test_output_and_stats_are_written_as_the_command_writes_them(command, tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    digest_of_command(command, tmp_path, source)
    result = isoshell.remesh(source, output=tmp_path / "ours.ply", stats=tmp_path / "ours.json", **SMALL)
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "out.ply").read_bytes()
    assert json.loads((tmp_path / "ours.json").read_text()) == result.report


def test_a_stage_file_resumes_as_with_the_command(tmp_path, ball):
    whole = isoshell.remesh(ball, save_shell=tmp_path / "shell.vdb", **SMALL)
    assert isoshell.remesh(tmp_path / "shell.vdb").digest == whole.digest


def test_estimate_is_that_of_a_dry_run(command, tmp_path):
    source = write_obj(tmp_path / "ball.obj", *make_ball())
    said = command(source, "--dry-run", *SMALL_WORDS).stderr
    found = isoshell.estimate(source, **SMALL)
    assert f"resolution {found['resolution']}," in said
    assert f"{found['sites']:,} site voxels" in said
    assert isoshell.estimate(make_ball(), **SMALL) == found
