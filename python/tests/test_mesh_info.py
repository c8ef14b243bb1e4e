"""Certificates are those of the command vdb_meshinfo, of files and of memory."""

import json
import os
import subprocess

import isoshell
import numpy as np
import pytest
from conftest import FOREVER, write_obj
from isoshell import ErrorCode

pytestmark = pytest.mark.filterwarnings("error")


@pytest.fixture
def certificate():
    """Runs the command with these arguments: its exit status and what it writes."""
    command = os.environ.get("VDB_MESHINFO")
    if not command:
        pytest.skip("VDB_MESHINFO names no command")

    def run(*arguments):
        done = subprocess.run([command, *map(str, arguments), "--json"], capture_output=True, text=True, timeout=FOREVER)
        return done.returncode, json.loads(done.stdout) if done.stdout else done.stderr

    return run


def without_paths(info):
    for given in ("mesh", "reference"):
        info[given]["path"] = ""
    return info


def test_a_file_has_the_certificate_of_the_command(certificate, nefertiti, ball, tmp_path):
    mesh = write_obj(tmp_path / "ball.obj", *ball)
    fewer = tmp_path / "fewer.ply"
    isoshell.remesh(nefertiti, vertices=2000, output=fewer)
    assert certificate(fewer) == (0, isoshell.mesh_info(fewer))
    assert certificate(mesh, "--ref", fewer) == (0, isoshell.mesh_info(mesh, ref=fewer, threads=1))


def test_arrays_have_the_certificate_of_their_file(certificate, ball, box, tmp_path):
    mesh, reference = write_obj(tmp_path / "ball.obj", *ball), write_obj(tmp_path / "box.obj", *box)
    info = isoshell.mesh_info(ball, ref=box)
    assert info["mesh"]["path"] == "(vertices, faces)" and info["reference"]["faces"] == 6
    assert without_paths(info) == without_paths(certificate(mesh, "--ref", reference)[1])
    assert without_paths(isoshell.mesh_info(isoshell.Mesh(*ball), ref=isoshell.Mesh(*ball))) == without_paths(
        isoshell.mesh_info(mesh, ref=mesh))


def test_a_result_is_measured_beside_what_it_was_made_of(ball):
    result = isoshell.remesh(ball, vertices=200, resolution=24)
    info = isoshell.mesh_info(result, ref=ball, require="closed,manifold,genus=0,no-self-intersections")
    assert info["topology"]["closed_manifold"] and info["topology"]["vertices"] == 200
    assert info["missed_gates"] == [] and info["distance"]["hausdorff_pct"] < 5


def test_a_ball_of_booleans_and_a_cloud_may_be_the_reference(ball):
    axis = np.arange(-20, 21) / 16
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    for inside in (x * x + y * y + z * z <= 1, np.sqrt(x * x + y * y + z * z) - 1):
        info = isoshell.mesh_info(ball, ref=isoshell.Volume(inside, spacing=1 / 16, origin=-1.25))
        assert info["reference"]["kind"] == "volume" and info["distance"]["to_reference"]["mean"] < 1 / 16
    cloud = isoshell.Points(ball[0], normals=ball[0])
    assert isoshell.mesh_info(ball, ref=cloud)["reference"]["kind"] == "points"


def test_a_cloud_stays_points_as_the_command_reads_it(certificate, ball, tmp_path):
    random = np.random.default_rng(1)
    points = random.uniform(-1, 1, (4_000, 3))
    points[np.arange(len(points)), random.integers(0, 3, len(points))] = random.choice([-1.0, 1.0], len(points))
    np.savetxt(tmp_path / "points.xyz", points, fmt="%.17g")
    mesh = write_obj(tmp_path / "ball.obj", *ball)
    of_command = certificate(mesh, "--ref", tmp_path / "points.xyz")[1]
    assert of_command == isoshell.mesh_info(mesh, ref=tmp_path / "points.xyz")
    assert of_command["distance"] == isoshell.mesh_info(mesh, ref=isoshell.Points(points))["distance"]
    assert of_command["distance"]["to_reference"] is None and of_command["reference"]["vertices"] == len(points)


def test_a_requirement_that_is_missed_is_an_error_with_the_certificate(certificate, ball, tmp_path):
    mesh = write_obj(tmp_path / "open.obj", ball[0], ball[1][:-1])
    with pytest.raises(isoshell.Error) as caught:
        isoshell.mesh_info(mesh, require=["closed", "components=1", "boundary-loops=2"])
    status, info = certificate(mesh, "--require", "closed,components=1,boundary-loops=2")
    assert caught.value.code == ErrorCode.GATE_FAILED == status
    assert caught.value.info == info and caught.value.result is None
    assert str(caught.value) == "; ".join(info["missed_gates"]) and len(info["missed_gates"]) == 2


@pytest.mark.parametrize("options, said", [
    ({"require": "max-deviation=1"}, "ref"),
    ({"require": "features"}, "leave it out"),
    ({"require": "round"}, "round"),
    ({"input_format": "obj"}, "input_format is for files"),
    ({"ref_format": "obj"}, "ref_format is for a ref in a file"),
    ({"threads": 0}, "threads"),
    ({"context": isoshell.Context(), "threads": 2}, "context"),
])
def test_what_cannot_be_asked_is_refused(ball, options, said):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.mesh_info(ball, **options)
    assert caught.value.code == ErrorCode.USAGE and said in str(caught.value)


def test_what_is_no_mesh_is_refused(ball, tmp_path):
    with pytest.raises(isoshell.Error) as caught:
        isoshell.mesh_info(isoshell.Points(ball[0], normals=ball[0]))
    assert caught.value.code == ErrorCode.USAGE and "points" in str(caught.value)
    with pytest.raises(isoshell.Error) as caught:
        isoshell.mesh_info(tmp_path / "none.obj")
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT


def test_progress_is_heard_and_may_stop_it(ball):
    heard = []
    isoshell.mesh_info(ball, ref=ball, context=isoshell.Context(progress=lambda stage, _: heard.append(stage)))
    assert {"read", "census", "distance"} <= set(heard)

    def stop(stage, fraction):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        isoshell.mesh_info(ball, ref=ball, context=isoshell.Context(progress=stop))
