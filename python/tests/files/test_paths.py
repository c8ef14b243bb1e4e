"""Names of files, and what becomes of files under them."""

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import isoshell
import numpy as np
import pytest
from conftest import write_obj
from isoshell import ErrorCode, _isoshell
from isoshell._report import write as write_page
from moving_shapes import twisted

SMALL = {"vertices": 100, "resolution": 32}


def calls_with(path, ball):
    """Every function that takes a path, given this one."""
    result, labels = isoshell.remesh(ball, **SMALL), isoshell.Labels(np.ones((3, 3, 3), np.int32))
    stages = isoshell.Stages(ball, **SMALL)
    yield from (lambda name=name: isoshell.remesh(ball, **{name: path}, **SMALL)
                for name in ("output", "stats", "report", "save_shell", "save_voronoi", "save_level_set",
                             "split_regions", "sizing", "features"))
    yield lambda: isoshell.remesh(path, **SMALL)
    yield lambda: isoshell.estimate(path, **SMALL)
    yield lambda: isoshell.Stages(path, **SMALL)
    yield lambda: isoshell.mesh_info(path)
    yield lambda: isoshell.mesh_info(ball, ref=path)
    yield lambda: list(isoshell.remesh_many([path], **SMALL))
    yield lambda: list(isoshell.remesh_sequence(path, frames=1, **SMALL))
    yield lambda: list(isoshell.remesh_sequence([path], **SMALL))
    yield lambda: list(isoshell.remesh_sequence([ball], output=path, **SMALL))
    yield lambda: list(isoshell.remesh_sequence([ball], stats=path, **SMALL))
    yield lambda: result.save(path)
    yield lambda: isoshell.report(result, path)
    yield lambda: isoshell.report(result, "page.html", source=path)
    yield lambda: labels.save(path)
    yield lambda: stages.save_shell(path)
    yield lambda: stages.save_voronoi(path)
    yield lambda: isoshell.usd.read(path)
    yield lambda: isoshell.usd.write(path, result)


@pytest.mark.parametrize("path", ["a\0b.ply", "a\0b.usda", Path("a\0b.ply"), "a.#\0b.ply"])
def test_a_nul_in_a_path_is_refused_wherever_a_path_is_taken(path, ball, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for call in calls_with(path, ball):
        with pytest.raises(isoshell.Error, match="NUL") as caught:
            call()
        assert caught.value.code == ErrorCode.USAGE
    assert os.listdir(tmp_path) == []


def test_half_a_character_in_a_path_is_refused(ball):
    for call in calls_with("a\ud800b.ply", ball):
        with pytest.raises(isoshell.Error, match="half a character"):
            call()


def test_the_library_refuses_a_nul_too():
    with pytest.raises(isoshell.Error, match="NUL") as caught:
        _isoshell.write_text("a\0b", "text", True)
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT


@pytest.mark.parametrize("name", ["out.ply", "s.json", "out.usda"])
def test_what_appears_while_a_run_goes_on_stays(name, ball, tmp_path):
    if name == "out.usda":
        pytest.importorskip("pxr")
    content = write_obj(tmp_path / "ball.obj", *ball).read_text()
    os.mkfifo(tmp_path / "pipe.obj")

    def write() -> None:
        with open(tmp_path / "pipe.obj", "w") as pipe:  # is open once the run reads, and so has looked at its outputs
            (tmp_path / name).write_text("mine")
            pipe.write(content)

    writer = threading.Thread(target=write)
    writer.start()
    with pytest.raises(isoshell.Error, match=f"{name}: exists already") as caught:
        isoshell.remesh(tmp_path / "pipe.obj", **{"stats" if name == "s.json" else "output": tmp_path / name}, **SMALL)
    writer.join()
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT
    assert (tmp_path / name).read_text() == "mine" and not [*tmp_path.glob(".*")]


def test_a_page_that_appears_while_it_is_made_stays(ball, tmp_path):
    pytest.importorskip("k3d")
    (tmp_path / "page.html").write_text("mine")
    with pytest.raises(isoshell.Error, match="page.html: exists already"):
        write_page(isoshell.remesh(ball, **SMALL), None, tmp_path / "page.html", False)
    assert (tmp_path / "page.html").read_text() == "mine" and os.listdir(tmp_path) == ["page.html"]


def test_a_stage_of_usd_and_another_output_are_two_files(ball, tmp_path):
    pytest.importorskip("pxr")
    (tmp_path / "s.json").write_text("mine")
    (tmp_path / "out.usda").symlink_to("s.json")
    with pytest.raises(isoshell.Error, match="are one file") as caught:
        isoshell.remesh(ball, output=tmp_path / "out.usda", stats=tmp_path / "s.json", force=True, **SMALL)
    assert caught.value.code == ErrorCode.USAGE and (tmp_path / "s.json").read_text() == "mine"


def test_a_dry_run_on_a_stage_of_usd_prints_its_estimate_as_json(ball, tmp_path):
    pytest.importorskip("pxr")
    isoshell.usd.write(tmp_path / "in.usda", isoshell.remesh(ball, **SMALL))
    done = subprocess.run([sys.executable, "-m", "isoshell", tmp_path / "in.usda", "--dry-run", "--stats", "-"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["estimate"]["vertices"] == 10000


def test_a_sequence_that_resumes_makes_again_what_is_not_of_it(tmp_path):
    frames, out = [twisted(n) for n in range(1, 4)], tmp_path / "out.#.ply"
    list(isoshell.remesh_sequence(frames, output=out, **SMALL))
    whole = [(tmp_path / f"out.{n}.ply").read_bytes() for n in range(1, 4)]
    (tmp_path / "out.2.ply").write_bytes(b"")
    with pytest.warns(isoshell.RunWarning, match="out.2.ply cannot be read.*it is made again"):
        made = isoshell.remesh_sequence(frames, output=out, resume=True, **SMALL)
        assert [result.frame for result in made] == [2] and made.found == [1, 3]
    assert [(tmp_path / f"out.{n}.ply").read_bytes() for n in range(1, 4)] == whole
    with pytest.warns(isoshell.RunWarning, match="other options"):
        other = isoshell.remesh_sequence(frames, output=out, resume=True, vertices=120, resolution=32)
        assert [len(result.vertices) for result in other] == [120] * 3
    frames[0] = twisted(9)
    with pytest.warns(isoshell.RunWarning, match="another input"):
        other = isoshell.remesh_sequence(frames, output=out, resume=True, vertices=120, resolution=32)
        assert [result.frame for result in other] == [1, 2, 3]
