"""Stages of USD with time samples as sequences, and sequences as stages."""

import os
import subprocess
import sys

import isoshell
import numpy as np
import pytest
from conftest import make_ball
from isoshell import ErrorCode

pytest.importorskip("pxr", reason="needs usd-core: pip install usd-core")
from pxr import Gf, Sdf, Usd, UsdGeom, Vt  # noqa: E402
from moving_shapes import MOTION, spin_between, twisted  # noqa: E402
from usd_stages import add_materials, add_mesh, complaints, new_stage, primvar, skinned, written  # noqa: E402

SMALL = {"vertices": 200, "features": "off"}


@pytest.fixture
def moving(tmp_path):
    """A stage with one mesh that is twisted from time code 1 to 4, at 48 time codes a second."""

    def make(change=lambda stage, mesh: None, name="in.usda"):
        stage = new_stage(tmp_path / name)
        stage.SetTimeCodesPerSecond(48)
        mesh = add_mesh(stage, "/World/Shape", *twisted(1))
        for time in range(1, 5):
            mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(twisted(time)[0].astype(np.float32)), time)
        change(stage, mesh)
        return written(stage)

    return make


def in_single_precision(frame):
    vertices, faces = twisted(frame)
    return vertices.astype(np.float32), faces


def opened(path):
    stage = Usd.Stage.Open(str(path))
    mesh, = (UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    return stage, mesh


def array(attribute, time):
    value = attribute.Get(time)
    return None if value is None else np.array(value)


def test_a_stage_gives_the_sequence_of_its_arrays(moving):
    expected = [r.digest for r in isoshell.remesh_sequence(map(in_single_precision, range(1, 5)), **SMALL)]
    for name in ("in.usda", "in.usdc"):
        made = list(isoshell.remesh_sequence(f"{moving(name=name)}:/World/Shape", **SMALL))
        assert [result.frame for result in made] == [1, 2, 3, 4]
        assert [result.digest for result in made] == expected
    part = list(isoshell.remesh_sequence(moving(name="again.usda"), frames="1-2", **SMALL))
    assert [result.digest for result in part] == expected[:2]


def test_transforms_and_visibility_and_topology_have_samples_too(tmp_path):
    stage = new_stage(tmp_path / "in.usda")
    moved = UsdGeom.Xformable(stage.GetPrimAtPath("/World")).AddTranslateOp()
    for time in (1, 2.5):
        moved.Set(Gf.Vec3d(time, 0, 0), time)
    mesh = add_mesh(stage, "/World/Shape", *make_ball(10))
    for time, rings in ((1, 10), (3, 14)):
        vertices, faces = make_ball(rings)
        mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(vertices.astype(np.float32)), time)
        mesh.GetFaceVertexCountsAttr().Set([3] * len(faces), time)
        mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(faces.astype(np.int32).reshape(-1)), time)
    UsdGeom.Imageable(add_mesh(stage, "/World/Other", *make_ball(10))).GetVisibilityAttr().Set("invisible", 0)
    UsdGeom.Camera.Define(stage, "/World/Camera").GetFocalLengthAttr().Set(35, 7)
    made = list(isoshell.remesh_sequence(written(stage), **SMALL))
    assert [result.frame for result in made] == [0, 1, 2.5, 3]
    assert np.allclose([result.vertices.mean(axis=0)[0] for result in made], [1, 1, 2.5, 2.5], atol=0.02)
    assert made[3].report["input"]["faces"] == len(make_ball(14)[1])
    with pytest.raises(isoshell.Error, match="frame 2.5: the time code 2.5 is no number"):
        list(isoshell.remesh_sequence(tmp_path / "in.usda", output=tmp_path / "out.#.ply", **SMALL))


def test_velocities_of_a_stage_take_vertices_along_where_faces_change(tmp_path):
    def made(with_velocities):
        stage = new_stage(tmp_path / f"in{with_velocities}.usda")
        UsdGeom.Xformable(stage.GetPrimAtPath("/World")).AddRotateZOp().Set(90)
        mesh = add_mesh(stage, "/World/Shape", *make_ball(16))
        for time in (0, 2):
            vertices, faces = make_ball(16 + time)
            mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(vertices.astype(np.float32)), time)
            mesh.GetFaceVertexCountsAttr().Set([3] * len(faces), time)
            mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(faces.astype(np.int32).reshape(-1)), time)
            if with_velocities:
                spin = np.cross([0, 0, 0.1 * 24 / 2], vertices).astype(np.float32)  # .1 in two time codes
                mesh.GetVelocitiesAttr().Set(Vt.Vec3fArray.FromNumpy(spin), time)
        return spin_between(*isoshell.remesh_sequence(written(stage), **SMALL))

    assert abs(made(True) - 0.1) < 0.01
    assert abs(made(False)) < 0.01


def test_a_stage_without_samples_and_what_is_no_frame_of_it_are_refused(moving, tmp_path):
    stage = new_stage(tmp_path / "still.usda")
    add_mesh(stage, "/World/Shape", *make_ball())
    with pytest.raises(isoshell.Error, match="nothing in it has time samples"):
        isoshell.remesh_sequence(written(stage))
    assert len(list(isoshell.remesh_sequence(tmp_path / "still.usda", frames="1-2", **SMALL))) == 2
    with pytest.raises(isoshell.Error, match="velocity"):
        isoshell.remesh_sequence(moving(), velocity="v")
    with pytest.raises(isoshell.Error, match="no prim /World/Nose"):
        isoshell.remesh_sequence(f"{moving()}:/World/Nose")


@pytest.mark.parametrize("ending", ["usda", "usdc", "usdz"])
def test_a_sequence_is_a_stage_with_time_samples(moving, tmp_path, ending):
    target = tmp_path / f"out.{ending}"
    made = list(isoshell.remesh_sequence(moving(), output=target, **SMALL))
    assert complaints(target) == []
    assert sorted(os.listdir(tmp_path)) == ["in.usda", f"out.{ending}"]
    stage, mesh = opened(target)
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (1, 4, 48)
    assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 0.01
    born, velocities = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("born"), mesh.GetVelocitiesAttr()
    for result in made:
        points = array(mesh.GetPointsAttr(), result.frame)
        assert np.array_equal(points, result.vertices.astype(np.float32))
        assert np.array_equal(array(mesh.GetFaceVertexIndicesAttr(), result.frame), result.faces.reshape(-1))
        assert np.array_equal(array(mesh.GetFaceVertexCountsAttr(), result.frame), np.full(len(result.faces), 3))
        assert np.array_equal(array(mesh.GetExtentAttr(), result.frame), [points.min(axis=0), points.max(axis=0)])
        if result.frame == 1:
            assert born.Get(1) is None and velocities.Get(1) is None
            continue
        assert np.array_equal(array(born, result.frame), result.attributes["born"])
        motion = np.column_stack([result.attributes[name] for name in ("vx", "vy", "vz")])
        assert np.allclose(array(velocities, result.frame), motion * 48)
    assert not MOTION & {p.GetPrimvarName() for p in UsdGeom.PrimvarsAPI(mesh).GetPrimvars()} - {"born"}
    again = isoshell.usd.read(target, time=3)
    assert np.array_equal(again.vertices, made[2].vertices.astype(np.float32))


def test_velocities_are_those_of_the_time_between_samples(tmp_path):
    with pytest.warns(isoshell.RunWarning, match="frame 3"):
        sources = [twisted(1), twisted(2), (twisted(3)[0][:0], twisted(3)[1]), twisted(4)]
        made = list(isoshell.remesh_sequence(sources, output=tmp_path / "out.usda", keep_going=True, **SMALL))
    assert complaints(tmp_path / "out.usda") == []
    stage, mesh = opened(tmp_path / "out.usda")
    assert mesh.GetPointsAttr().GetTimeSamples() == [1, 2, 4] and stage.GetTimeCodesPerSecond() == 24
    for result, codes in zip(made[1:], (1, 2)):
        velocities = array(mesh.GetVelocitiesAttr(), result.frame)[:, 0]
        assert np.allclose(velocities, result.attributes["vx"] * 24 / codes)


def test_attributes_and_materials_have_samples_and_none_where_a_frame_lacks_them(moving, tmp_path):
    faces = twisted(1)[1]

    def change(stage, mesh):
        for time in (1, 3):
            heat = primvar(mesh, "heat", Sdf.ValueTypeNames.FloatArray, "vertex", np.zeros(len(twisted(1)[0])).tolist())
            heat.Set(Vt.FloatArray(len(twisted(1)[0]), float(time)), time)
        primvar(mesh, "st", Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying", [(0, 0), (1, 0), (1, 1)],
                [0, 1, 2] * len(faces))
        primvar(mesh, "kind", Sdf.ValueTypeNames.StringArray, "uniform", ["old", "new"], [0] * len(faces))
        primvar(mesh, "weight", Sdf.ValueTypeNames.FloatArray, "constant", [4])
        add_materials(stage, mesh)

    options = {"vertices": 300, "attributes": ["heat", "kind", "weight", "uv", "material"]}
    made = list(isoshell.remesh_sequence(moving(change), output=tmp_path / "out.usdc", **options))
    assert complaints(tmp_path / "out.usdc") == []
    stage, mesh = opened(tmp_path / "out.usdc")
    primvars = UsdGeom.PrimvarsAPI(mesh)
    for result in made:
        assert np.allclose(array(primvars.GetPrimvar("heat"), result.frame), result.attributes["heat"])
        assert len(primvars.GetPrimvar("st").ComputeFlattened(result.frame)) == 3 * len(result.faces)
        assert set(primvars.GetPrimvar("kind").ComputeFlattened(result.frame)) == {"old"}
        assert np.allclose(array(primvars.GetPrimvar("weight"), result.frame), 4)
        again = isoshell.usd.read(tmp_path / "out.usdc", time=result.frame)
        ours, theirs = np.array(result.labels["material"]), np.array(again.labels["material"])
        assert np.array_equal(ours[result.attributes["material"]], theirs[again.of_faces["material"]])


def test_what_a_frame_lacks_has_no_value_there(tmp_path):
    vertices, faces = twisted(1)
    heat = isoshell.Mesh(vertices, faces, of_vertices={"heat": vertices[:, 0]})
    red = isoshell.Mesh(vertices, faces, of_faces={"material": np.zeros(len(faces), np.int32)},
                        labels={"material": ["red"]})
    other = isoshell.Mesh(vertices, faces, of_faces={"heat": np.arange(len(faces))})
    with pytest.warns(isoshell.RunWarning, match="the primvar heat is left out"):
        list(isoshell.remesh_sequence([(vertices, faces), heat, red, other], output=tmp_path / "out.usda", **SMALL))
    assert complaints(tmp_path / "out.usda") == []
    stage, mesh = opened(tmp_path / "out.usda")
    values = [UsdGeom.PrimvarsAPI(mesh).GetPrimvar("heat").Get(time) for time in (1, 2, 3, 4)]
    assert [value is not None for value in values] == [False, True, False, False]
    indices = stage.GetPrimAtPath(mesh.GetPath().AppendChild("red")).GetAttribute("indices")
    assert [len(indices.Get(time)) > 0 for time in (1, 2, 3, 4)] == [False, False, True, False]


def test_one_material_of_all_faces_is_bound_to_the_mesh(tmp_path):
    vertices, faces = twisted(1)
    red = isoshell.Mesh(vertices, faces, of_faces={"material": np.zeros(len(faces), np.int32)},
                        labels={"material": ["red"]})
    list(isoshell.remesh_sequence([red, red], output=tmp_path / "out.usda", **SMALL))
    assert complaints(tmp_path / "out.usda") == []
    stage, mesh = opened(tmp_path / "out.usda")
    assert not mesh.GetPrim().GetChildren()
    assert isoshell.usd.read(tmp_path / "out.usda").labels["material"] == ["red"]


def test_a_stage_is_there_after_the_last_frame_and_nothing_before(moving, tmp_path):
    source = moving()
    made = isoshell.remesh_sequence(source, output=tmp_path / "out.usda", **SMALL)
    next(made)
    made.close()
    assert os.listdir(tmp_path) == ["in.usda"]
    made = isoshell.remesh_sequence(source, output=tmp_path / "out.usda", require="born=0,genus=3", **SMALL)
    with pytest.raises(isoshell.Error, match="frame 1"):
        list(made)
    assert os.listdir(tmp_path) == ["in.usda"]
    (tmp_path / "out.usda").write_text("there")
    with pytest.raises(isoshell.Error, match="exists") as caught:
        isoshell.remesh_sequence(source, output=tmp_path / "out.usda")
    assert caught.value.code == ErrorCode.UNWRITABLE_OUTPUT


def test_a_stage_for_each_frame_in_and_out(moving, tmp_path):
    made = list(isoshell.remesh_sequence(moving(), output=tmp_path / "out.##.usdc", frames="1-3", **SMALL))
    assert complaints(tmp_path / "out.02.usdc") == []
    again = list(isoshell.remesh_sequence(tmp_path / "out.##.usdc", frames="1-3", **SMALL))
    assert [len(result.vertices) for result in again] == [len(result.vertices) for result in made] == [200] * 3
    with pytest.raises(isoshell.Error, match="out.02.usdc: exists"):
        isoshell.remesh_sequence(tmp_path / "in.usda", output=tmp_path / "out.##.usdc", frames="2-4", **SMALL)
    with pytest.raises(isoshell.Error, match="frame 4, .*out.04.usdc"):
        isoshell.remesh_sequence(f"{tmp_path}/out.##.usdc:/World/Shape", frames="3-4")


def test_the_memory_of_a_stage_does_not_grow_with_its_samples(tmp_path, monkeypatch):
    monkeypatch.setattr("isoshell._usd._samples.HELD_BYTES", 0)
    made, sizes = [], [0]
    for result in isoshell.remesh_sequence([twisted(n) for n in range(6)], output=tmp_path / "out.usda", **SMALL):
        made.append(result)
        sizes.append(sum(path.stat().st_size for path in tmp_path.glob(".isoshell-*/*")))
    assert np.all(np.diff(sizes) > result.vertices.nbytes / 2)
    assert complaints(tmp_path / "out.usda") == []
    _, mesh = opened(tmp_path / "out.usda")
    for result in made:
        assert np.array_equal(array(mesh.GetPointsAttr(), result.frame), result.vertices.astype(np.float32))


def test_a_skeleton_is_told_of_once(moving):
    with pytest.warns(isoshell.RunWarning) as told:
        assert len(list(isoshell.remesh_sequence(moving(skinned), **SMALL))) == 4
    assert ["skeleton" in str(warning.message) for warning in told] == [True]


def test_python_m_isoshell_takes_sequences_of_stages(moving, tmp_path):
    def run(*words):
        return subprocess.run([sys.executable, "-m", "isoshell", *map(str, words), "--vertices", "200", "--features",
                               "off"], capture_output=True, text=True)

    out, ply = tmp_path / "out.usda", tmp_path / "out.#.ply"
    source = moving()
    done = run(source, out, "--frames", "1-4", "--stats", tmp_path / "s.#.json")
    assert done.returncode == 0, done.stderr
    assert "4 frames made; edges kept" in done.stderr and complaints(out) == []
    _, mesh = opened(out)
    assert mesh.GetPointsAttr().GetTimeSamples() == [1, 2, 3, 4]
    assert run(source, ply, "--frames=1-4").returncode == 0
    done = run(source, ply, "--frames", "1-5", "--resume")
    assert done.returncode == 0 and "1 frame made, 4 there already" in done.stderr, done.stderr
    for number, result in enumerate(isoshell.remesh_sequence(source, frames="1-5", **SMALL), 1):
        result.save(tmp_path / "ours.ply", overwrite=True)
        assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / f"out.{number}.ply").read_bytes()
    assert run(source, out, "--frames", "1-4").returncode == ErrorCode.UNWRITABLE_OUTPUT
    assert run(source, out, "--keep-going", "--force").returncode == ErrorCode.USAGE
    assert run(source, "--frames", "1-4", "--dry-run").returncode == ErrorCode.USAGE
    for quiet in ([], ["--quiet"]):
        done = run(source, out, "--frames", "1-2", "--force", "--keep-going", "--require", "genus=3", *quiet)
        assert done.returncode == ErrorCode.GATE_FAILED and done.stderr.count("genus=3") == 2, done.stderr
