"""Stages of USD that the tests write, and how they are changed."""

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, Vt

SMALL = {"vertices": 100, "resolution": 32}


def new_stage(path, up="Z", unit=0.01):
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, up)
    UsdGeom.SetStageMetersPerUnit(stage, unit)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/World").GetPrim())
    return stage


def add_mesh(stage, path, vertices, faces, scheme="none"):
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(np.asarray(vertices, np.float32)))
    mesh.CreateFaceVertexCountsAttr([len(face) for face in faces])
    mesh.CreateFaceVertexIndicesAttr([int(corner) for face in faces for corner in face])
    if scheme:
        mesh.CreateSubdivisionSchemeAttr(scheme)
    return mesh


def primvar(mesh, name, kind, interpolation, values, indices=None):
    made = UsdGeom.PrimvarsAPI(mesh.GetPrim()).CreatePrimvar(name, kind, interpolation)
    made.Set(values)
    if indices is not None:
        made.SetIndices(indices)
    return made


def written(stage):
    stage.GetRootLayer().Save()
    return stage.GetRootLayer().realPath


@pytest.fixture
def stage_of(tmp_path):
    """Saves a stage with one mesh, /World/Shape, that a function may change before."""

    def make(shape, change=lambda stage, mesh: None, name="in.usda"):
        stage = new_stage(tmp_path / name)
        change(stage, add_mesh(stage, "/World/Shape", *shape))
        return written(stage)

    return make


def colored(stage, mesh):
    """Every kind of primvar on a cube of six quads."""
    types = Sdf.ValueTypeNames
    primvar(mesh, "displayColor", types.Color3fArray, "uniform", [(1, 0, 0), (0, 0, 1)], [0, 0, 0, 1, 1, 1])
    primvar(mesh, "st", types.TexCoord2fArray, "faceVarying", [(0, 0), (1, 0), (1, 1), (0, 1)], [0, 1, 2, 3] * 6)
    primvar(mesh, "map2", types.TexCoord2fArray, "faceVarying", [(0, 0), (1, 0), (1, 1), (0, 1)], [3, 0, 1, 2] * 6)
    primvar(mesh, "heat", types.FloatArray, "vertex", [0, 1] * 4)
    primvar(mesh, "my:flux", types.Half2Array, "uniform", [(1, 2)] * 6)
    primvar(mesh, "cold", types.DoubleArray, "varying", [0.5] * 8)
    primvar(mesh, "flow", types.Vector3fArray, "vertex", [(1, 2, 3)] * 8)
    primvar(mesh, "part", types.IntArray, "uniform", [0, 0, 0, 7, 7, 7])
    primvar(mesh, "kind", types.StringArray, "uniform", ["wood", "steel"], [0, 0, 0, 1, 1, 1])
    primvar(mesh, "weight", types.FloatArray, "constant", [4])
    mesh.CreateNormalsAttr([(0, 0, -1)] * 6)
    mesh.SetNormalsInterpolation("uniform")
