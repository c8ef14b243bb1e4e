"""Grids of .vdb files as values of a result's vertices."""

import subprocess

import isoshell
import numpy as np
import pytest
from conftest import COMMAND, FOREVER, python_of_openvdb
from isoshell import ErrorCode

SMALL = {"vertices": 200, "resolution": 40}
WRITER = """
import sys
try: import pyopenvdb as vdb
except ImportError: import openvdb as vdb
import numpy as np

at = 0.25 * (np.stack(np.meshgrid(*3 * [np.arange(16)], indexing="ij"), -1) - 7.5)
def grid(kind, name, values):
    made = kind()
    made.copyFromArray(values.astype(np.float32))
    made.transform = vdb.createLinearTransform(
        [[0.25, 0, 0, 0], [0, 0.25, 0, 0], [0, 0, 0.25, 0], [-1.875, -1.875, -1.875, 1]])
    made.name = name
    return made
size = np.linalg.norm(at, axis=-1)
surface = grid(vdb.FloatGrid, "surface", size - 1)
surface.gridClass, surface.background = vdb.GridClass.LEVEL_SET, 1
for path in sys.argv[1:]:
    vdb.write(path, grids=[surface, grid(vdb.Vec3SGrid, "v", at * (2, 3, 4)), grid(vdb.Vec3SGrid, "Cd", 0.5 + at / 4),
                           grid(vdb.FloatGrid, "heat", at[..., 0]), grid(vdb.Vec3SGrid, "rest", at)])
"""


@pytest.fixture(scope="session")
def frames(tmp_path_factory):
    """A pattern of two frames of a ball of radius 1, with values that are linear in the place."""
    python = python_of_openvdb()
    if python is None:
        pytest.skip("needs the Python module of OpenVDB")
    folder = tmp_path_factory.mktemp("grids")
    files = [folder / f"in.{frame}.vdb" for frame in (1, 2)]
    done = subprocess.run([python, "-s", "-c", WRITER, *files], capture_output=True, text=True, timeout=FOREVER)
    assert done.returncode == 0, done.stderr
    return f"{folder}/in.#.vdb"


def frame(pattern, number=1):
    return pattern.replace("#", str(number))


@pytest.mark.parametrize("grids", ["v,Cd,heat", ["v", "Cd", "heat"]])
def test_a_volume_gives_its_grids_to_the_vertices(frames, grids):
    result = isoshell.remesh(f"{frame(frames)}:surface", grids=grids, **SMALL)
    found, at = result.attributes, result.vertices
    assert list(found) == ["v.0", "v.1", "v.2", "color", "heat"]
    assert np.allclose(np.stack([found[f"v.{i}"] for i in range(3)], 1), at * (2, 3, 4), atol=1e-5)
    assert np.allclose(found["color"], 0.5 + at / 4, atol=1e-6) and found["color"].shape == (200, 3)
    assert found["heat"].dtype == np.float32 and np.allclose(found["heat"], at[:, 0], atol=1e-6)
    assert [grid["name"] for grid in result.report["attributes"]["grids"]] == ["v", "Cd", "heat"]


def test_the_command_reads_the_same_from_standard_input(frames, tmp_path):
    isoshell.remesh(frame(frames), grids="all", output=tmp_path / "file.ply", **SMALL)
    words = ["-", tmp_path / "pipe.ply", "--input-format", "vdb", "--grids", "all", "--vertices", 200,
             "--resolution", 40]
    with open(frame(frames), "rb") as file:
        done = subprocess.run([*COMMAND, *map(str, words)], stdin=file, capture_output=True, text=True, timeout=FOREVER)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "pipe.ply").read_bytes() == (tmp_path / "file.ply").read_bytes()


def test_memory_and_meshes_take_grids_of_files(frames, ball):
    file = frame(frames)
    result = isoshell.remesh(ball, grids=f"{file}:heat", **SMALL)
    assert np.allclose(result.attributes["heat"], result.vertices[:, 0], atol=1e-6)
    again = isoshell.remesh(result, **SMALL)
    assert np.allclose(again.attributes["heat"], again.vertices[:, 0], atol=0.05)
    with pytest.raises(isoshell.Error, match="is no volume of a .vdb file") as refused:
        isoshell.remesh(ball, grids="heat", **SMALL)
    assert refused.value.code == ErrorCode.USAGE
    with pytest.raises(isoshell.Error, match=r'has no grid "w".*"heat" \(Tree_float_5_4_3\)'):
        isoshell.remesh(f"{file}:surface", grids="w", **SMALL)


def lattice(size=17, step=0.25):
    """Places of an array around a ball of radius 1."""
    return step * (np.stack(np.meshgrid(*3 * [np.arange(size)], indexing="ij"), -1) - size // 2)


def test_arrays_on_the_lattice_of_a_volume_are_values_of_its_vertices():
    at = lattice()
    source = isoshell.Volume(np.linalg.norm(at, axis=-1) - 1, spacing=0.25, origin=-2)
    result = isoshell.remesh(source, grids={"heat": at[..., 0], "v": at * (2, 3, 4), "side": (at[..., 0] > 0).astype(int)}, **SMALL)
    found, where = result.attributes, result.vertices
    assert list(found) == ["heat", "v.0", "v.1", "v.2", "side"]
    assert np.allclose(found["heat"], where[:, 0], atol=1e-5)
    assert np.allclose(np.stack([found[f"v.{i}"] for i in range(3)], 1), where * (2, 3, 4), atol=1e-4)
    assert found["side"].dtype == np.int32 and set(found["side"]) == {0, 1}
    assert isoshell.estimate(source, grids={"heat": at[..., 0]}, **SMALL)["sites"] > 0


def test_any_source_takes_grids_that_say_where_they_stand(ball, tmp_path):
    at = lattice().astype(np.float32)
    everywhere = np.indices(at.shape[:3]).reshape(3, -1).T
    sparse = {"coordinates": everywhere, "spacing": 0.25, "origin": -2}
    distances = isoshell.level_set(ball, resolution=40)
    result = isoshell.remesh(ball, grids={
        "dense": isoshell.Volume(at[..., 1], spacing=0.25, origin=-2),
        "sparse": isoshell.Volume(at[..., 1].reshape(-1), **sparse), "v": isoshell.Volume(at.reshape(-1, 3), **sparse),
        "distance": distances}, **SMALL)
    found, where = result.attributes, result.vertices
    assert np.allclose(found["dense"], where[:, 1], atol=1e-5) and np.array_equal(found["dense"], found["sparse"])
    assert np.allclose(found["v.2"], where[:, 2], atol=1e-5)
    assert np.abs(found["distance"]).max() < distances.voxel_size
    distances.save(tmp_path / "set.vdb")
    of_file = isoshell.remesh(ball, grids={"distance": (tmp_path / "set.vdb").read_bytes()}, **SMALL)
    assert np.allclose(of_file.attributes["distance"], found["distance"], atol=1e-6)
    with pytest.raises(isoshell.Error, match="has no grid .w."):
        isoshell.remesh(ball, grids=f"{tmp_path}/set.vdb:w", **SMALL)


def test_a_level_set_as_a_grid_is_negative_beyond_its_band(ball):
    around = isoshell.level_set(ball, resolution=80, level_set_band=2)
    vertices, faces = ball
    found = isoshell.remesh(vertices * 0.2, faces, grids={"distance": around}, **SMALL).attributes["distance"]  # far inside
    assert np.allclose(found, -around.background)


def test_whole_numbers_may_be_masked(ball):
    side = np.ma.masked_array(np.full((17, 17, 17), 2**40), np.ones((17, 17, 17), bool))
    side[4:13, 4:13, 4:13] = 7
    grid = isoshell.Volume(side, spacing=0.5, origin=-4)
    assert set(isoshell.remesh(ball, grids={"side": grid}, **SMALL).attributes["side"]) == {7}


def test_grids_in_memory_that_cannot_be_are_refused(ball):
    at = lattice()

    def refusal(given, source=ball):
        with pytest.raises(isoshell.Error) as refused:
            isoshell.remesh(source, grids={"heat": given}, **SMALL)
        assert refused.value.code == ErrorCode.USAGE
        return str(refused.value)

    assert "say where it stands" in refusal(at[..., 0])
    assert "it must be an isoshell.Volume" in refusal("heat")
    assert "has the shape (17, 17, 17, 2)" in refusal(isoshell.Volume(at[..., :2]))
    assert "not interpolated" in refusal(isoshell.Volume((at[..., 0] * 1e8).astype(np.int64)))
    odd = np.zeros(at.shape[:3], np.int64)
    odd[3, 2, 1] = 2**24 + 1  # which becomes 2**24 in single precision
    assert "not interpolated" in refusal(isoshell.Volume(odd))
    assert "not interpolated" in refusal(isoshell.Volume(np.ma.masked_array(odd, np.arange(odd.size).reshape(odd.shape) == 0)))
    for wrong in (np.inf, 1e300):
        heat = at[..., 0].copy()
        heat[3, 2, 1] = wrong
        assert "value [3, 2, 1] is inf" in refusal(isoshell.Volume(heat))
    assert "of NanoVDB" in refusal(b"NanoVDB0" + bytes(1000))
    with pytest.raises(isoshell.Error) as refused:
        isoshell.remesh(ball, grids={"heat": isoshell.Volume(np.zeros((400, 400, 400), np.float32))}, max_memory="100M", **SMALL)
    assert refused.value.code == ErrorCode.OUT_OF_MEMORY and str(refused.value).startswith("heat: its values take")
    with pytest.raises(isoshell.Error, match="a name of grids is 3"):
        isoshell.remesh(ball, grids={3: isoshell.Volume(at[..., 0])}, **SMALL)
    with pytest.raises(isoshell.Error, match="those of one run"):
        list(isoshell.remesh_many([ball], grids={"heat": isoshell.Volume(at[..., 0])}, **SMALL))


def test_a_stage_has_velocities_colours_and_vectors(frames, tmp_path):
    pxr = pytest.importorskip("pxr.UsdGeom", reason="needs usd-core: pip install usd-core")
    from pxr import Usd

    result = isoshell.remesh(f"{frame(frames)}:surface", grids="all", output=tmp_path / "out.usda", **SMALL)
    stage = Usd.Stage.Open(str(tmp_path / "out.usda"))
    mesh, = (pxr.Mesh(prim) for prim in stage.Traverse() if prim.IsA(pxr.Mesh))
    primvars = pxr.PrimvarsAPI(mesh.GetPrim())
    assert np.allclose(mesh.GetVelocitiesAttr().Get(), result.vertices * (2, 3, 4) * 24, atol=1e-3)
    assert np.allclose(primvars.GetPrimvar("displayColor").Get(), 0.5 + result.vertices / 4, atol=1e-5)
    assert primvars.GetPrimvar("rest").GetTypeName() == "float3[]"
    assert np.allclose(primvars.GetPrimvar("rest").Get(), result.vertices, atol=1e-5)
    assert not primvars.GetPrimvar("v")


def test_each_frame_of_a_sequence_has_them(frames, tmp_path):
    pxr = pytest.importorskip("pxr.UsdGeom", reason="needs usd-core: pip install usd-core")
    from pxr import Usd

    made = list(isoshell.remesh_sequence(f"{frames}:surface", frames="1-2", grids=["v", f"{frames}:heat"],
                                         output=tmp_path / "out.usdc", **SMALL))
    assert [np.allclose(result.attributes["heat"], result.vertices[:, 0], atol=1e-6) for result in made] == [True] * 2
    stage = Usd.Stage.Open(str(tmp_path / "out.usdc"))
    mesh, = (pxr.Mesh(prim) for prim in stage.Traverse() if prim.IsA(pxr.Mesh))
    for result in made:
        assert np.allclose(mesh.GetVelocitiesAttr().Get(result.frame), result.vertices * (2, 3, 4) * 24, atol=1e-3)
