"""Stages of USD that cannot be read or written, and what is said of them."""

import sys

import isoshell
import numpy as np
import pytest
from isoshell import ErrorCode

pytest.importorskip("pxr", reason="needs usd-core: pip install usd-core")
from pxr import Usd, UsdGeom, Vt  # noqa: E402
from usd_stages import SMALL, add_mesh, colored, new_stage, stage_of, written  # noqa: E402, F401, fixture


def test_without_usd_core_the_error_says_what_to_install(stage_of, tmp_path, ball, monkeypatch):
    path = stage_of(ball)
    monkeypatch.setitem(sys.modules, "pxr", None)
    for ask in (lambda: isoshell.remesh(path), lambda: isoshell.remesh(ball, output=tmp_path / "out.usda")):
        with pytest.raises(isoshell.Error, match=r"isoshell\[usd\]") as caught:
            ask()
        assert caught.value.code == ErrorCode.USAGE


def test_other_outputs_and_outputs_that_cannot_be_are_refused_before_the_run(tmp_path, ball):
    for options in ({"output": tmp_path / "none/out.usda"}, {"output": f"{tmp_path}/out.usda:/World"},
                    {"output": tmp_path / "out.usda", "stop_after": "shell"},
                    {"output": tmp_path / "out.usdz", "save_shell": tmp_path / "out.shell.vdb"}):
        with pytest.raises(isoshell.Error) as caught:
            isoshell.remesh(ball, progress=lambda stage, part: pytest.fail("it runs"), **options)
        assert caught.value.code in (ErrorCode.USAGE, ErrorCode.UNWRITABLE_OUTPUT)
    (tmp_path / "no.vdb").write_bytes(b"no volume at all")
    with pytest.raises(isoshell.Error, match="no OpenVDB file"):
        isoshell.usd.write(tmp_path / "out.usda", isoshell.remesh(ball, **SMALL), volumes=[tmp_path / "no.vdb"])


@pytest.mark.parametrize("points, counts, corners, place", [
    ([(0, 0, 0)] * 3, [3], [0, 1, 3], r"faceVertexIndices\[2\] is 3"),
    ([(0, 0, 0)] * 3, [3], [0, -1, 2], r"faceVertexIndices\[1\] is -1"),
    ([(0, 0, 0)] * 3, [3, 3], [0, 1, 2], "sum up to 6"),
    ([(0, 0, 0)] * 3, [-3], [0, 1, 2], r"faceVertexCounts\[0\] is -3"),
    ([], [3], [0, 1, 2], "0 points"),
])
def test_a_mesh_that_contradicts_itself_is_refused_by_its_prim(tmp_path, points, counts, corners, place):
    stage = new_stage(tmp_path / "in.usda")
    mesh = UsdGeom.Mesh.Define(stage, "/World/Wrong")
    mesh.CreatePointsAttr(points)
    mesh.CreateFaceVertexCountsAttr(counts)
    mesh.CreateFaceVertexIndicesAttr(corners)
    with pytest.raises(isoshell.Error, match=f"/World/Wrong: .*{place}") as caught:
        isoshell.remesh(written(stage))
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT


def test_a_stage_without_a_mesh_says_what_it_has(tmp_path):
    stage = new_stage(tmp_path / "in.usda")
    UsdGeom.Sphere.Define(stage, "/World/Ball")
    path = written(stage)
    with pytest.raises(isoshell.Error, match="1 Sphere") as caught:
        isoshell.remesh(path)
    assert caught.value.code == ErrorCode.NOTHING_TO_MESH
    with pytest.raises(isoshell.Error, match="no prim /World/Nose") as caught:
        isoshell.remesh(f"{path}:/World/Nose")
    assert caught.value.code == ErrorCode.USAGE


def test_a_reference_that_is_not_there_is_a_warning(tmp_path, box):
    stage = new_stage(tmp_path / "in.usda")
    add_mesh(stage, "/World/Box", *box)
    stage.DefinePrim("/World/Lost").GetReferences().AddReference("./lost.usda")
    with pytest.warns(isoshell.RunWarning, match="not resolved"):
        isoshell.usd.read(written(stage))


def test_damaged_files_raise_errors_and_nothing_else(stage_of, tmp_path, box):
    text = open(stage_of(box, colored), "rb").read()
    binary = open(stage_of(box, colored, "in.usdc"), "rb").read()
    random = np.random.default_rng(1)
    for i in range(30):
        damaged = bytearray(text)
        for at in random.choice([at for at, byte in enumerate(text) if chr(byte) in "0123456789-."], 3):
            damaged[at] = ord("0123456789-e."[random.integers(13)])
        (tmp_path / f"{i}.usda").write_bytes(damaged)
        (tmp_path / f"{i}.usdc").write_bytes(binary[:random.integers(len(binary))])
        for ending in ("usda", "usdc"):
            try:
                isoshell.usd.read(tmp_path / f"{i}.{ending}")
            except isoshell.Error as error:
                assert error.code == ErrorCode.UNREADABLE_INPUT
            else:
                assert ending == "usda"


@pytest.mark.parametrize("key, data", [
    ("regions", 7), ("regions", "text"), ("regions", Vt.IntArray([1])), ("regions", Vt.DoubleArray([1, 0])),
    ("region_names", "text"), ("region_names", {"names": 3}), ("region_names", {"names": {"a": "b"}}),
    ("region_names", {"names": {"99999999999": "b"}}), ("region_names", {"background": "none"})])
def test_notes_of_regions_that_are_none_are_told_with_their_prim(tmp_path, key, data):
    labels = np.zeros((12, 8, 8), np.uint8)
    labels[2:6, 2:6, 2:6], labels[6:10, 2:6, 2:6] = 3, 7
    path = str(tmp_path / "regions.usda")
    isoshell.usd.write(path, isoshell.remesh(isoshell.Labels(labels), vertices=200))
    stage = Usd.Stage.Open(path)
    for prim in stage.Traverse():
        if prim.HasCustomDataKey(f"isoshell:{key}"):
            prim.SetCustomDataByKey(f"isoshell:{key}", data)
    stage.Save()
    with pytest.raises(isoshell.Error, match=f"/World.*isoshell:{key} is") as caught:
        isoshell.remesh(path, **SMALL)
    assert caught.value.code == ErrorCode.UNREADABLE_INPUT
