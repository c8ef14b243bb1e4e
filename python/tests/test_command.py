"""python -m isoshell is the command, and its first word names what to do."""

import json
import os
import re
import subprocess
import sys
from importlib import import_module

import isoshell
import numpy as np
import pytest
from conftest import SOURCE, write_obj
from isoshell._remesh_command import has_inputs_alone, split_words

COMMANDS = ("remesh", "info", "farm")


def run(*arguments, **settings):
    words = [sys.executable, "-m", "isoshell", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, errors="surrogateescape", **settings)


def test_it_takes_the_arguments_of_the_command(tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    done = run(source, tmp_path / "out.ply", "--vertices", 60, "--resolution", 24)
    assert done.returncode == 0 and "60 vertices" in done.stderr
    isoshell.remesh(source, vertices=60, resolution=24).save(tmp_path / "module.ply")
    assert (tmp_path / "module.ply").read_bytes() == (tmp_path / "out.ply").read_bytes()


def test_its_exit_statuses_are_those_of_the_command(tmp_path):
    assert run("--version").stdout.split()[1] == isoshell.__version__
    assert "--close-gaps W" in run("remesh", "--help").stdout
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


def test_its_help_names_what_it_can_do():
    for word in ("--help", "-h"):
        said = run(word)
        assert said.returncode == 0 and said.stdout.startswith("isoshell COMMAND ") and "vdb_isomesh" not in said.stdout
        assert all(f"\n  {name} " in said.stdout for name in COMMANDS) and "USD" in said.stdout
    assert run("--version").stdout == run("-V").stdout == f"isoshell {isoshell.__version__}\n"


@pytest.mark.parametrize("name, says", [("remesh", "--close-gaps W"), ("info", "--ref INPUT"), ("farm", "status"),
                                        ("farm run", "--retry-failed")])
def test_each_command_has_a_help_under_its_name(name, says):
    said = run(*name.split(), "--help")
    assert said.returncode == 0 and f"isoshell {name} " in said.stdout.splitlines()[0] and says in said.stdout


def test_the_help_names_files_of_other_packages():
    said = run("remesh", "--help").stdout.split("Size of the result:")[0].split("OUTPUT  a mesh")
    assert all("(.usd .usda .usdc .usdz" in part for part in said)
    for format in isoshell._exchange.formats():
        assert [f".{format.ending}" in re.split(r"[ ()]", part) for part in said] == [format.reads, format.writes]


def test_a_command_alone_says_what_it_lacks():
    for words, says in (((), "isoshell: error: COMMAND is missing"), (("remesh",), "isoshell remesh: error: "),
                        (("info",), "isoshell info: error: MESH is missing"),
                        (("farm",), "isoshell farm: error: the following arguments are required: run|status|report"),
                        (("farm", "run"), "isoshell farm run: error: the following arguments are required: ASSETS")):
        said = run(*words)
        assert said.returncode == 2 and says in said.stderr and said.stdout == "", said.stderr
    assert "did you mean info?" in run("inof", "mesh.ply").stderr


@pytest.mark.parametrize("name", ["remesh.vdb:sdf", "remesh.usd:/a", "remesh.#.ply", "remesh.%d.ply", "farm.ply", "a/inf"])
def test_what_can_name_a_file_is_no_misspelt_command(tmp_path, name):
    words = ("out.#.ply", "--frames", "1-1") if {"#", "%"} & {*name} else ("out.ply",)
    done = run(name, *words, cwd=tmp_path)
    assert done.returncode == 3 and "did you mean" not in done.stderr, done.stderr


def test_options_that_repeat_do_so_where_python_reads_or_writes_the_file():
    words = ["a.usda", "b.ply", "--region-edge-length", "a=1", "--region-edge-length=b=2", "--seed", "3", "--seed", "4"]
    assert split_words(words) == (["a.usda", "b.ply"], {"region_edge_length": "a=1\nb=2", "seed": "4"})


def test_a_dry_run_has_an_output_only_where_the_command_has_one():
    dry = {"dry_run": True}
    assert has_inputs_alone(["a.ply"], dry) and has_inputs_alone(["a.vdb", "b.vdb:piece*"], dry)
    for places, options in ((["a.ply", "b.ply"], dry), (["a.vdb", "b.ply"], dry), (["a.vdb", "b.vdb"], {}),
                            (["a.vdb", "b.vdb"], {**dry, "stop_after": "shell"})):
        assert not has_inputs_alone(places, options)


def test_remesh_is_what_the_call_without_a_name_does(tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    options = ("--vertices", 60, "--resolution", 24)
    for number, words in enumerate([(source, "0.ply"), ("remesh", source, "1.ply"), ("remesh", source, "-o", "2.ply"),
                                    ("-o3.ply", source)]):
        done = run(*words, *options, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / f"{number}.ply").read_bytes() == (tmp_path / "0.ply").read_bytes()
        assert done.stderr.startswith("isoshell remesh: ")
    twice = run(source, "4.ply", "-o", "5.ply", cwd=tmp_path)
    assert twice.returncode == 2 and "'4.ply' and as --output '5.ply'" in twice.stderr


def test_info_is_the_certificate(tmp_path, ball):
    source = write_obj(tmp_path / "ball.obj", *ball)
    table = run("info", source)
    assert table.returncode == 0 and "closed 2-manifold" in table.stdout
    assert json.loads(run("info", source, "--json").stdout) == isoshell.mesh_info(source)
    assert run("info", source, "--require", "genus=3").returncode == 6
    assert run("info", "-V").stdout == f"isoshell info {isoshell.__version__}\n"


def test_info_measures_files_of_other_packages_as_its_own(tmp_path, ball):
    pytest.importorskip("meshio")
    source, other = write_obj(tmp_path / "ball.obj", *ball), tmp_path / "ball.vtu"
    isoshell.Mesh(*ball).to_meshio().write(other)
    told = [run("info", source), run("info", other)]
    assert told[0].returncode == 0 and (told[0].stdout, told[0].stderr) == (told[1].stdout, told[1].stderr)
    assert json.loads(run("info", other, "--json").stdout) == isoshell.mesh_info(other)
    near = json.loads(run("info", source, "--ref", other, "--json", "--require", "max-deviation=1e-6").stdout)
    assert near["distance"]["hausdorff"] < 1e-6
    assert run("info", other, "--require", "genus=3").returncode == 6
    twice = run("info", other, "--stats", other, "--force")
    assert twice.returncode == 2 and "are one file" in twice.stderr
    assert ".vtu" in run("info", "--help").stdout
    nibabel = pytest.importorskip("nibabel")
    nibabel.save(nibabel.Nifti1Image(np.pad(np.ones((3, 3, 3), np.int16), 1), np.eye(4)), tmp_path / "a.nii.gz")
    assert "a.nii.gz is no mesh but labels" in run("info", tmp_path / "a.nii.gz").stderr


def test_info_measures_a_prim_of_a_stage_and_tells_its_warnings(tmp_path, ball):
    pytest.importorskip("pxr")
    stage = tmp_path / "ball.usda"
    isoshell.usd.write(stage, isoshell.remesh(ball, vertices=60, resolution=24))
    stage.write_text(stage.read_text() + 'def "gone" (references = @gone.usda@) {}\n')
    for word in (stage, f"{stage}:/World"):
        done = run("info", word)
        assert done.returncode == 0 and "closed 2-manifold" in done.stdout, done.stderr
        assert done.stderr.startswith("isoshell info: warning: ") and "RunWarning" not in done.stderr


@pytest.mark.parametrize("name", ["a.vtu", "a.usda"])
def test_info_says_why_it_cannot_read_a_file_of_another_package(tmp_path, name):
    pytest.importorskip("meshio" if name == "a.vtu" else "pxr")
    absent = run("info", name, cwd=tmp_path)
    assert absent.returncode == 3 and f"isoshell info: error: {name}: no such file" in absent.stderr
    (tmp_path / name).write_text("<")
    done = run("info", name, cwd=tmp_path)
    assert done.returncode == 3 and f"isoshell info: error: {name}: " in done.stderr, done.stderr
    assert "Traceback" not in done.stderr and done.stdout == ""


def test_scripts_of_the_package_are_there(capfd, monkeypatch):
    scripts = re.findall(r'^(\w+) = "(isoshell\.\w+):(\w+)"$', (SOURCE / "pyproject.toml").read_text(), re.MULTILINE)
    assert [name for name, _, _ in scripts] == ["isoshell", "vdb_meshinfo"]
    for name, module, function in scripts:
        monkeypatch.setattr(sys, "argv", [name, "--version"])
        assert getattr(import_module(module), function)() == 0
        assert capfd.readouterr().out == f"{name} {isoshell.__version__}\n"


@pytest.mark.parametrize("name", COMMANDS)
def test_a_file_that_is_called_as_a_command_has_a_folder(tmp_path, ball, name):
    write_obj(tmp_path / name, *ball)
    words = ("--input-format", "obj", "--vertices", 60, "--resolution", 24)
    wrong = run(name, "out.ply", *words, cwd=tmp_path)
    assert wrong.returncode == 2 and f"the file of that name is ./{name}" in wrong.stderr, wrong.stderr
    assert run(f"./{name}", "out.ply", *words, cwd=tmp_path).returncode == 0
