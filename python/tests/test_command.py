"""python -m isoshell is the command."""

import json
import os
import subprocess
import sys

import isoshell
import pytest
from conftest import write_obj


def run(*arguments):
    return subprocess.run([sys.executable, "-m", "isoshell", *map(str, arguments)], capture_output=True, text=True,
                          errors="surrogateescape")


def test_it_takes_the_arguments_of_the_command(tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    done = run(source, tmp_path / "out.ply", "--vertices", 60, "--resolution", 24)
    assert done.returncode == 0 and "60 vertices" in done.stderr
    isoshell.remesh(source, vertices=60, resolution=24).save(tmp_path / "module.ply")
    assert (tmp_path / "module.ply").read_bytes() == (tmp_path / "out.ply").read_bytes()


def test_its_exit_statuses_are_those_of_the_command(tmp_path):
    assert run("--version").stdout.split()[1] == isoshell.__version__
    assert "--close-gaps W" in run("--help").stdout
    assert run().returncode == 2
    assert run("a.obj", "b.ply", "--verticse", 7).returncode == 2
    assert run(tmp_path / "none.obj", tmp_path / "out.ply").returncode == 3


def test_names_that_are_not_utf_8_are_read_written_and_told(tmp_path, ball):
    """As for the command, for which a name is bytes."""
    source, target = (tmp_path / os.fsdecode(name) for name in (b"b\xff.obj", b"o\xfe.ply"))
    write_obj(source, *ball)
    options = {"vertices": 60, "resolution": 24}
    result = isoshell.remesh(source, output=target, stats=True, **options)
    assert result.report["input"]["path"].endswith(".obj")
    result.save(tmp_path / os.fsdecode(b"p\xfe.ply"))
    statistics = tmp_path / os.fsdecode(b"s\xfe.json")
    done = run(source, target, "--force", "--vertices", 60, "--resolution", 24, "--stats", statistics)
    assert done.returncode == 0, done.stderr
    assert {os.fsencode(path.name) for path in tmp_path.iterdir()} == {
        b"b\xff.obj", b"o\xfe.ply", b"p\xfe.ply", b"s\xfe.json"}
    assert len({path.read_bytes() for path in tmp_path.glob("*.ply")}) == 1
    assert json.loads(statistics.read_text())["counts"]["vertices"] == 60
    with pytest.raises(isoshell.Error, match="none\udcff.obj"):
        isoshell.remesh(tmp_path / os.fsdecode(b"none\xff.obj"), **options)
