"""Stages of USD as sources, and results as stages."""

import os
import re
import shutil
import subprocess
import sys

import isoshell
import numpy as np
import pytest
from conftest import SOURCE
from isoshell import ErrorCode

pytest.importorskip("pxr", reason="needs usd-core: pip install usd-core")
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdSkel, UsdVol, Vt  # noqa: E402
from usd_stages import (  # noqa: E402, F401, fixture
    SMALL,
    add_materials,
    add_mesh,
    colored,
    complaints,
    new_stage,
    primvar,
    skinned,
    stage_of,
    written,
)


def written_mesh(path):
    """The stage of a file, its one mesh, and where its points are in the world."""
    stage = Usd.Stage.Open(str(path))
    mesh, = (UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    matrix = np.array(UsdGeom.XformCache().GetLocalToWorldTransform(mesh.GetPrim()))
    points = np.array(mesh.GetPointsAttr().Get(), np.float64)
    return stage, mesh, points @ matrix[:3, :3] + matrix[3, :3]


def test_a_stage_gives_the_mesh_of_its_arrays(stage_of, ball, box):
    as_stored = ball[0].astype(np.float32)
    assert isoshell.remesh(stage_of(ball), **SMALL).digest == isoshell.remesh((as_stored, ball[1]), **SMALL).digest
    path = stage_of(box, name="box.usdc")
    for source in (path, f"{path}:/World/Shape", f"{path}:/World", f"{path}:World/Shape", isoshell.usd.read(path)):
        assert isoshell.remesh(source, **SMALL).digest == isoshell.remesh(box, **SMALL).digest


def test_polygons_are_split_as_from_arrays_and_triangles_among_them_keep_their_order(stage_of):
    faces = [(0, 1, 2), (0, 3, 4, 1), (3, 5, 5, 4), (0, 2, 5, 3), (1, 4, 5), (1, 5, 2)]
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)], np.float64)
    read = isoshell.usd.read(stage_of((points, faces)))
    assert read.faces.tolist()[0] == [0, 1, 2] and len(read.faces) == 8
    assert isoshell.remesh(read, **SMALL).digest == isoshell.remesh((points, faces), **SMALL).digest


def test_transforms_are_applied_one_in_the_other_and_in_double_precision(stage_of, ball):
    def change(stage, mesh):
        UsdGeom.Xformable(stage.GetPrimAtPath("/World")).AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(
            Gf.Vec3d(1e6, 2e6, 0))
        mesh.AddScaleOp().Set(Gf.Vec3f(0.001, 0.002, 0.001))

    read = isoshell.usd.read(stage_of(ball, change))
    stored = ball[0].astype(np.float32).astype(float)
    assert np.array_equal(read.vertices, stored * np.float64(np.float32([0.001, 0.002, 0.001])) + [1e6, 2e6, 0])


def volume_of(mesh):
    a, b, c = (np.asarray(mesh.vertices)[mesh.faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


@pytest.mark.parametrize("left_handed", [False, True])
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_outside_stays_outside(stage_of, box, left_handed, mirrored):
    def change(stage, mesh):
        if left_handed:
            mesh.CreateOrientationAttr("leftHanded")
            mesh.GetFaceVertexIndicesAttr().Set([int(c) for face in box[1] for c in face[::-1]])
        if mirrored:
            mesh.AddScaleOp().Set(Gf.Vec3f(-1, 1, 1))

    assert np.isclose(volume_of(isoshell.usd.read(stage_of(box, change))), 1)


def test_faces_of_hole_indices_are_no_faces_and_a_subdivision_surface_is_its_cage(stage_of, box, caplog):
    def change(stage, mesh):
        mesh.CreateHoleIndicesAttr([1])
        mesh.CreateSubdivisionSchemeAttr("catmullClark")

    with caplog.at_level("INFO", "isoshell"):
        assert len(isoshell.usd.read(stage_of(box, change)).faces) == 10
    assert "read as their cages" in caplog.text


def test_meshes_that_are_not_seen_are_read_when_they_are_named(tmp_path, ball):
    stage = new_stage(tmp_path / "in.usda")
    add_mesh(stage, "/World/Seen", *ball)
    UsdGeom.Imageable(add_mesh(stage, "/World/Hidden", *ball)).MakeInvisible()
    add_mesh(stage, "/World/Proxy", *ball).CreatePurposeAttr("proxy")
    path, count = written(stage), len(ball[1])
    assert len(isoshell.usd.read(path).faces) == count
    assert len(isoshell.usd.read(path, purposes=["proxy", "default"]).faces) == 2 * count
    assert len(isoshell.usd.read(f"{path}:/World/Hidden").faces) == count


def test_references_instances_and_instancers_stand_where_they_are_placed(tmp_path, box):
    part = new_stage(tmp_path / "part.usda")
    add_mesh(part, "/World/Box", *box)
    part_path = written(part)
    stage = new_stage(tmp_path / "in.usda")
    for i in range(3):
        prim = UsdGeom.Xform.Define(stage, f"/World/Part{i}")
        prim.GetPrim().GetReferences().AddReference(os.path.basename(part_path))
        prim.GetPrim().SetInstanceable(i > 0)
        prim.AddTranslateOp().Set(Gf.Vec3d(10 * i, 0, 0))
    many = UsdGeom.PointInstancer.Define(stage, "/World/Many")
    many.AddTranslateOp().Set(Gf.Vec3d(0, 50, 0))
    add_mesh(stage, "/World/Many/Kinds/Box", *box)
    many.CreatePrototypesRel().AddTarget("/World/Many/Kinds/Box")
    many.CreateProtoIndicesAttr([0, 0, 0])
    many.CreatePositionsAttr([(0, 0, 0), (10, 0, 0), (20, 0, 0)])
    many.InvisId(1, Usd.TimeCode.Default())
    read = isoshell.usd.read(written(stage))
    lows = {tuple(low) for low in read.vertices.reshape(-1, 8, 3).min(axis=1).tolist()}
    assert lows == {(0, 0, 0), (10, 0, 0), (20, 0, 0), (0, 50, 0), (20, 50, 0)}


def test_time_codes_choose_points_and_transforms(stage_of, box):
    def change(stage, mesh):
        stage.SetStartTimeCode(1)
        stage.SetEndTimeCode(5)
        move = mesh.AddTranslateOp()
        for time in (0, 1, 5):
            mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy((box[0] * (1 + time)).astype(np.float32)), time)
            move.Set(Gf.Vec3d(time, 0, 0), time)

    path = stage_of(box, change)
    for time, at in ((None, 1), (5, 5), (3, 3)):
        assert np.allclose(isoshell.usd.read(path, time=time).vertices, box[0] * (1 + at) + [at, 0, 0])


def blended(stage, mesh):
    shape = UsdSkel.BlendShape.Define(stage, "/World/Shape/Smile")
    UsdSkel.BindingAPI.Apply(mesh.GetPrim()).CreateBlendShapeTargetsRel().AddTarget(shape.GetPath())


@pytest.mark.parametrize("change", [skinned, blended])
def test_a_mesh_that_moves_with_a_skeleton_is_read_as_it_rests_with_a_warning(stage_of, ball, change):
    with pytest.warns(isoshell.RunWarning, match="/World/Shape moves with a skeleton or blend shapes") as told:
        isoshell.remesh(stage_of(ball, change), **SMALL)
    assert told[0].filename == __file__


def test_a_skeleton_that_binds_no_mesh_is_no_reason_to_warn(stage_of, ball, recwarn):
    isoshell.usd.read(stage_of(ball, lambda stage, mesh: UsdSkel.Skeleton.Define(stage, "/World/Skeleton")))
    assert not recwarn.list


def test_primvars_of_every_interpolation_are_attributes(stage_of, box):
    read = isoshell.usd.read(stage_of(box, colored))
    assert set(read.of_vertices) == {"heat", "cold", "flow.0", "flow.1", "flow.2"}
    assert set(read.of_faces) == {"color", "part", "kind", "weight", "my:flux.0", "my:flux.1"}
    assert set(read.of_corners) == {"uv", "uv1", "normal"}
    assert read.of_faces["color"].tolist() == [[1, 0, 0]] * 6 + [[0, 0, 1]] * 6
    assert read.of_faces["kind"].tolist() == [1] * 6 + [0] * 6 and read.labels["kind"] == ["steel", "wood"]
    assert read.of_vertices["flow.1"].tolist() == [2] * 8 and read.of_faces["weight"].tolist() == [4] * 12
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    for corners, uv in zip(read.faces.tolist(), read.of_corners["uv"].tolist()):
        face = next(face for face in box[1].tolist() if set(corners) <= set(face))
        assert uv == [square[face.index(corner)] for corner in corners]


def test_normals_turn_with_their_mesh(stage_of, box):
    def change(stage, mesh):
        mesh.CreateNormalsAttr([(1, 1, 0)] * 8)
        mesh.SetNormalsInterpolation("vertex")
        mesh.AddScaleOp().Set(Gf.Vec3f(-2, 1, 1))

    normals = isoshell.usd.read(stage_of(box, change)).of_corners["normal"].reshape(-1, 3)
    assert np.allclose(normals / np.linalg.norm(normals, axis=1)[:, None], np.array([-1, 2, 0]) / np.sqrt(5))


def test_primvars_that_do_not_fit_are_left_out_with_a_warning(stage_of, box):
    def change(stage, mesh):
        primvar(mesh, "short", Sdf.ValueTypeNames.FloatArray, "vertex", [1, 2])
        primvar(mesh, "wild", Sdf.ValueTypeNames.FloatArray, "vertex", [1, 2], [9] * 8)

    with pytest.warns(isoshell.RunWarning) as told:
        read = isoshell.usd.read(stage_of(box, change))
    assert not read.of_vertices
    assert ["short" in str(told[0].message), "wild" in str(told[1].message)] == [True, True]


def test_bound_materials_are_the_attribute_material(stage_of, box):
    read = isoshell.usd.read(stage_of(box, add_materials))
    assert read.labels["material"] == ["Blue", "Red"]
    assert read.of_faces["material"].tolist() == [0] * 4 + [1] * 8


@pytest.mark.parametrize("ending", ["usda", "usdc", "usd", "usdz"])
def test_a_round_trip_keeps_points_primvars_materials_units_and_axis(stage_of, tmp_path, box, ending):
    def change(stage, mesh):
        colored(stage, mesh)
        add_materials(stage, mesh)

    result = isoshell.remesh(stage_of(box, change), vertices=300, features=30)
    result.save(tmp_path / f"out.{ending}")
    assert complaints(tmp_path / f"out.{ending}") == []
    stage, mesh, points = written_mesh(tmp_path / f"out.{ending}")
    assert UsdGeom.GetStageUpAxis(stage) == "Z" and UsdGeom.GetStageMetersPerUnit(stage) == 0.01
    assert mesh.GetPath() == "/World/Shape" and mesh.GetSubdivisionSchemeAttr().Get() == "none"
    assert np.array_equal(points, result.vertices.astype(np.float32))
    assert np.array_equal(np.array(mesh.GetFaceVertexIndicesAttr().Get()), result.faces.reshape(-1))
    assert np.allclose(mesh.GetExtentAttr().Get(), [points.min(axis=0), points.max(axis=0)])
    again = isoshell.usd.read(tmp_path / f"out.{ending}")
    for name, values in result.attributes.items():
        of_all = {**again.of_vertices, **again.of_faces, **again.of_corners}
        if name in ("kind", "material"):
            ours, theirs = np.array(result.labels[name]), np.array(again.labels[name])
            assert np.array_equal(ours[values], theirs[of_all[name]])
        elif name != "gap":
            assert np.allclose(of_all[name], values, atol=1e-6), name
    primvars = {p.GetPrimvarName(): p for p in UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvars()}
    assert str(primvars["flow"].GetTypeName()) == "vector3f[]" and primvars["weight"].GetInterpolation() == "constant"
    for name in ("st", "map2"):
        assert primvars[name].GetInterpolation() == "faceVarying" and primvars[name].IsIndexed()
    assert str(primvars["cold"].GetTypeName()) == "double[]" and str(primvars["my:flux"].GetTypeName()) == "half2[]"
    blue = UsdShade.Shader.Get(stage, "/World/Materials/Blue/Picture").GetInput("file").Get()
    assert os.path.exists(blue.resolvedPath) or ending == "usdz" and blue.resolvedPath.endswith(".png]")
    assert UsdShade.Shader.Get(stage, "/World/Materials/Red/Surface").GetInput("roughness").Get() == 0.25


def test_points_far_from_the_origin_keep_their_shape(tmp_path, ball):
    far = isoshell.remesh((ball[0] + [1e6, 2e6, -3e6], ball[1]), **SMALL)
    far.save(tmp_path / "far.usda")
    assert complaints(tmp_path / "far.usda") == []
    assert np.abs(written_mesh(tmp_path / "far.usda")[2] - far.vertices).max() < 1e-6


def test_a_result_that_knows_no_scene_has_y_up_and_metres_unless_told(tmp_path, ball):
    result = isoshell.remesh(ball, **SMALL)
    result.save(tmp_path / "out.usda")
    isoshell.usd.write(tmp_path / "other.usda", result, up_axis="Z", meters_per_unit=0.001)
    for name, axis, unit in (("out", "Y", 1), ("other", "Z", 0.001)):
        stage = Usd.Stage.Open(str(tmp_path / f"{name}.usda"))
        assert (UsdGeom.GetStageUpAxis(stage), UsdGeom.GetStageMetersPerUnit(stage)) == (axis, unit)
    with pytest.raises(isoshell.Error, match="up_axis"):
        isoshell.usd.write(tmp_path / "wrong.usda", result, up_axis="X")


def test_one_stage_binds_mesh_shell_and_voronoi_volumes_at_one_place(tmp_path, ball):
    moved = ball[0] * 2 + [30, 20, 10]
    (tmp_path / "volumes").mkdir()
    result = isoshell.remesh((moved, ball[1]), **SMALL, output=tmp_path / "out.usda",
                             save_shell=tmp_path / "volumes/out.shell.vdb",
                             save_voronoi=tmp_path / "volumes/out.voronoi.vdb")
    shutil.move(tmp_path / "volumes", tmp_path / "moved_volumes")
    assert any("Missing" in what or "resolv" in what.lower() for what in complaints(tmp_path / "out.usda"))
    shutil.move(tmp_path / "moved_volumes", tmp_path / "volumes")
    assert complaints(tmp_path / "out.usda") == []
    stage, mesh, points = written_mesh(tmp_path / "out.usda")
    frame = isoshell.Stages((moved, ball[1]), **SMALL).frame
    for name, field in (("shell", "shell_distance"), ("voronoi", "seed_id")):
        volume = UsdVol.Volume.Get(stage, f"/World/{name}")
        asset = UsdVol.OpenVDBAsset.Get(stage, volume.GetFieldPath(field))
        assert asset.GetFilePathAttr().Get().path == f"./volumes/out.{name}.vdb"
        assert asset.GetFieldNameAttr().Get() == field
        assert asset.GetFieldDataTypeAttr().Get() == {"shell_distance": "float", "seed_id": "int"}[field]
        low, high = np.array(volume.GetExtentAttr().Get())
        assert np.all(low <= points.min(axis=0)) and np.all(high >= points.max(axis=0))
        assert np.all(high - low <= np.ptp(points, axis=0) + 8 * frame["voxel_size"])
    assert np.array_equal(points, result.vertices.astype(np.float32))


def test_a_level_set_is_a_volume_that_no_validator_complains_of(tmp_path, ball, monkeypatch):
    """As docs/guide/pipelines.md has it: beside its mesh, and alone by OpenUSD's own module."""
    monkeypatch.chdir(tmp_path)
    page = (SOURCE / "docs/guide/pipelines.md").read_text()
    isoshell.remesh(ball, output="scan.ply", **SMALL)
    line = re.search(r"^    isoshell (scan.ply scan.usda .*)$", page, re.M)[1]
    done = subprocess.run([sys.executable, "-m", "isoshell", *line.split()], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    exec(re.search(r"```python\n(.*?)```", page, re.S)[1], {})
    for name, prim in (("scan", "scan_distances"), ("volume", "scan")):
        assert complaints(tmp_path / f"{name}.usda") == []
        stage = Usd.Stage.Open(f"{name}.usda")
        volume = UsdVol.Volume.Get(stage, f"/World/{prim}")
        asset = UsdVol.OpenVDBAsset.Get(stage, volume.GetFieldPath("surface"))
        assert (asset.GetFieldNameAttr().Get(), asset.GetFieldClassAttr().Get()) == ("surface", "levelSet")
        assert os.path.samefile(asset.GetFilePathAttr().Get().resolvedPath, "scan_distances.vdb")


def test_the_command_takes_stages(stage_of, tmp_path, ball):
    def run(*words):
        return subprocess.run([sys.executable, "-m", "isoshell", *map(str, words)], capture_output=True, text=True)

    source, target = stage_of(ball), tmp_path / "out.usda"
    done = run(source, target, "--vertices", 100, "--resolution=32")
    assert done.returncode == 0 and "out.usda: 100 vertices, 196 triangles" in done.stderr, done.stderr
    expected = isoshell.remesh(source, **SMALL).vertices.astype(np.float32)
    assert np.array_equal(written_mesh(target)[2], expected)
    assert run(source, target).returncode == ErrorCode.UNWRITABLE_OUTPUT
    assert run(source, target, "--verticse", 7).returncode == ErrorCode.USAGE
    assert run(source, target, "--vertices").returncode == ErrorCode.USAGE
    assert run(source, "--dry-run").returncode == 0
    assert run(tmp_path / "none.usda", target, "--force").returncode == ErrorCode.UNREADABLE_INPUT
    gate = run(source, target, "--force", "--quiet", "--vertices", 100, "--resolution", 32, "--require", "genus=3")
    assert gate.returncode == ErrorCode.GATE_FAILED and "genus" in gate.stderr
    assert run(source, tmp_path / "out.ply", "--vertices", 100, "--resolution", 32).returncode == 0
    for number, named in enumerate((["-o", tmp_path / "0.usda"], [f"-o{tmp_path / '1.usda'}"], ["-qo", tmp_path / "2.usda"])):
        assert run(source, *named, "--vertices", 100, "--resolution", 32).returncode == 0
        assert np.array_equal(written_mesh(tmp_path / f"{number}.usda")[2], expected)


def test_a_far_mesh_stands_where_it_is_or_less_an_offset(tmp_path, ball):
    far = np.asarray(ball[0]) + (500_000, 5_400_000, 300), ball[1]
    result = isoshell.remesh(far, vertices=500, device="cpu")
    result.save(tmp_path / "a.usda")
    assert np.abs(written_mesh(tmp_path / "a.usda")[2] - result.vertices).max() < 1e-5
    with pytest.warns(isoshell.RunWarning, match="500000 5400000 300 is subtracted"):
        isoshell.remesh(far, vertices=500, device="cpu", output=tmp_path / "b.usda", recenter="auto")
    stage, _, points = written_mesh(tmp_path / "b.usda")
    assert stage.GetRootLayer().comment.endswith("offset 500000 5400000 300")
    assert np.abs(points + (500_000, 5_400_000, 300) - result.vertices).max() < 1e-5
