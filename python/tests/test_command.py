"""python -m isoshell is the command."""

import subprocess
import sys

import isoshell
from conftest import write_obj


def run(*arguments):
    return subprocess.run([sys.executable, "-m", "isoshell", *map(str, arguments)], capture_output=True, text=True)


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
