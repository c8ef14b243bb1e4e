"""Keywords are the options of the command."""

import pickle
import subprocess
import sys
from pathlib import Path
from typing import get_type_hints

import isoshell
import numpy as np
import pytest
from conftest import SOURCE
from isoshell import ErrorCode, _isoshell

TABLE = {option.name.replace("-", "_"): option for option in _isoshell.option_table()}
SEQUENCES = {"frames", "velocity", "no_coherence", "keep_going", "resume"}
NO_KEYWORDS = {"help", "version", "dry_run", "output"} | SEQUENCES  # output is a parameter


def test_there_is_a_keyword_for_every_option():
    assert set(isoshell.Options.__annotations__) == set(TABLE) - NO_KEYWORDS


def test_the_table_of_keywords_is_the_one_that_the_script_makes():
    folder = str(Path(_isoshell.__file__).parent)
    made = subprocess.run([sys.executable, SOURCE / "scripts/python_options.py"], env={"PYTHONPATH": folder},
                          capture_output=True, text=True, check=True).stdout
    assert made == (SOURCE / "python/isoshell/_options.py").read_text(), "run scripts/python_options.py --update"


def refusal(**options):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh("none.obj", **options)
    assert caught.value.code == ErrorCode.USAGE == 2
    return str(caught.value)


@pytest.mark.parametrize("mistyped, meant", [
    ("verticse", "vertices"), ("edge_lenght", "edge_length"), ("closegaps", "close_gaps"),
    ("edge-length", "edge_length"),
])
def test_an_unknown_keyword_is_refused_with_the_nearest(mistyped, meant):
    for value in (7, True, None, "text"):
        message = refusal(**{mistyped: value})
        assert mistyped in message and f"did you mean {meant}?" in message


@pytest.mark.parametrize("options, words", [
    ({"vertices": 3}, ["vertices is 3", "4 to"]),
    ({"vertices": 3.5}, ["vertices is '3.5'", "whole number"]),
    ({"vertices": "many"}, ["vertices is 'many'", "whole number"]),
    ({"vertices": True}, ["vertices is True"]),
    ({"vertices": [1, 2]}, ["vertices is [1, 2]"]),
    ({"edge_length": float("nan")}, ["edge_length"]),
    ({"edge_length": -1}, ["edge_length is -1"]),
    ({"outer_only": 1}, ["outer_only is 1", "True or False"]),
    ({"outer_only": "yes"}, ["outer_only is 'yes'", "True or False"]),
    ({"method": "cube"}, ["method is 'cube'", "sheet, shell"]),
    ({"features": "sharp"}, ["features"]),
    ({"close_gaps": "wide"}, ["close_gaps is 'wide'"]),
    ({"seed": -1}, ["seed is '-1'"]),
    ({"device": "gpu"}, ["device is 'gpu'", "cuda"]),
    ({"threads": 0}, ["threads"]),
    ({"max_memory": "lots"}, ["size"]),
    ({"require": "beautiful"}, ["beautiful"]),
    ({"progress": "loud"}, ["progress is 'loud'"]),
    ({"vertices": 100, "edge_length": 0.1}, ["vertices", "edge_length"]),
    ({"verbose": True, "quiet": True}, ["verbose and quiet"]),
    ({"stop_after": "shell", "output": "out.ply"}, ["stop_after"]),
    ({"method": "shell", "adaptivity": 0.5}, ["adaptivity"]),
    ({"dry_run": True}, ["dry_run", "isoshell.estimate"]),
    ({"frames": "1-9"}, ["frames", "remesh_sequence"]),
    ({"help": True}, ["help(isoshell.Options)"]),
])
def test_a_value_that_cannot_be_is_refused_by_the_name_of_its_keyword(options, words):
    message = refusal(**options)
    assert all(word in message for word in words), message
    assert "--" not in message


def test_none_and_false_are_as_if_the_keyword_were_not_there(ball):
    small = isoshell.remesh(ball, vertices=60, resolution=24)
    none = dict.fromkeys(set(TABLE) - NO_KEYWORDS - {"vertices", "resolution"})
    false = {name: False for name in none if not TABLE[name].value}
    assert isoshell.remesh(ball, vertices=60, resolution=24, **{**none, **false}).digest == small.digest


def test_lists_of_names_are_the_texts_with_commas(box):
    small = {"vertices": 200, "resolution": 32}
    isoshell.remesh(box, require=["closed", "manifold", "genus=0"], **small)
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(box, require=["closed", "genus=1", "components=2"], **small)
    error = caught.value
    assert error.code == ErrorCode.GATE_FAILED == 6 and "genus" in str(error)
    assert len(error.result.vertices) == 200
    assert isoshell.remesh(box, require=[], attributes=[], **small).digest == error.result.digest


def test_features_may_name_a_file_of_lines(tmp_path, box):
    (tmp_path / "line.obj").write_text("v 0 0 1\nv 1 1 1\nl 1 2\n")
    options = {"vertices": 300, "features": f"30,{tmp_path / 'line.obj'}"}
    result = isoshell.remesh(box, stats=True, **options)
    assert result.report["features"]["lines"] == 1 and result.report["options"]["features"] == options["features"]
    [of_many] = isoshell.remesh_many([box], **options)
    assert of_many.digest == result.digest


def test_error_codes_are_the_exit_statuses():
    assert {code.name: int(code) for code in ErrorCode} == {
        "INTERNAL": 1, "USAGE": 2, "UNREADABLE_INPUT": 3, "UNWRITABLE_OUTPUT": 4, "NOTHING_TO_MESH": 5,
        "GATE_FAILED": 6, "OUT_OF_MEMORY": 7, "NO_DEVICE": 8, "INTERRUPTED": 130}


def test_errors_survive_pickling():
    error = pickle.loads(pickle.dumps(isoshell.Error("what", ErrorCode.OUT_OF_MEMORY, "memory")))
    assert (str(error), error.code, error.stage) == ("what", ErrorCode.OUT_OF_MEMORY, "memory")


def test_a_run_over_its_memory_is_refused(nefertiti):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(nefertiti, max_memory="2M")
    assert caught.value.code == ErrorCode.OUT_OF_MEMORY


def test_a_device_that_is_not_there_is_refused(ball):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.remesh(ball, device="cuda:1023")
    assert caught.value.code == ErrorCode.NO_DEVICE


def test_hints_of_keywords_can_be_resolved():
    assert get_type_hints(isoshell.Options)["outer_only"] is bool


@pytest.mark.parametrize("value", [1e2, np.float64(100), np.int64(100), 100])
def test_whole_numbers_may_be_floats(ball, value):
    assert len(isoshell.remesh(ball, vertices=value, resolution=32.0, threads=1.0, max_memory=1e9).vertices) == 100


@pytest.mark.parametrize("value", [1000.5, 1e300, float("inf"), float("nan"), True])
def test_no_other_numbers_are_counts(ball, value):
    with pytest.raises(isoshell.Error, match="vertices") as caught:
        isoshell.remesh(ball, vertices=value)
    assert caught.value.code == isoshell.ErrorCode.USAGE


@pytest.mark.parametrize("theirs, ours", [
    ("faces", "vertices"), ("face_count", "vertices"), ("n_vertices", "vertices"), ("targetfacenum", "vertices"),
    ("target_edge_length", "edge_length"), ("targetlen", "edge_length"), ("isovalue", "iso"), ("feature_angle", "features"),
    ("overwrite", "force"), ("n_jobs", "threads"), ("size_field", "sizing"), ("pitch", "voxel_size")])
def test_names_by_which_others_call_options_are_answered_with_ours(ball, theirs, ours):
    with pytest.raises(isoshell.Error, match=f"unknown option {theirs}; did you mean {ours}\\b") as caught:
        isoshell.remesh(ball, **{theirs: 100})
    assert caught.value.code == isoshell.ErrorCode.USAGE


def test_vertices_and_faces_may_stand_by_themselves(ball):
    small = {"vertices": 100, "resolution": 32}
    expected = isoshell.remesh(ball, **small)
    assert isoshell.remesh(*ball, **small).digest == expected.digest
    assert isoshell.estimate(*ball, **small) == isoshell.estimate(ball, **small)
    assert isoshell.Stages(*ball, **small).triangulate().digest == expected.digest
    assert isoshell.mesh_info(*ball)["topology"] == isoshell.mesh_info(ball)["topology"]
    for wrong in ((*ball, 7), ("ball.ply", ball[1])):
        with pytest.raises(isoshell.Error, match=r"remesh\(V, F\)"):
            isoshell.remesh(*wrong)
    with pytest.raises(isoshell.Error, match=r"by position: remesh\(V, F\)"):
        isoshell.remesh(ball[0], faces=ball[1])
