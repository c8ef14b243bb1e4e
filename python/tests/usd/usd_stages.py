"""Stages of USD that the tests write, how they are changed, and what validators say of them."""

import os

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdSkel, UsdValidation, Vt

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


def complaints(path):
    """What every validator that usd-core has says of a file."""
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 20
    errors = UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(str(path)))
    return [f"{error.GetName()}: {error.GetMessage()}" for error in errors]


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


def add_materials(stage, mesh):
    """Red for the whole cube, and blue with a picture for two of its sides."""
    for name in ("Red", "Blue"):
        material = UsdShade.Material.Define(stage, f"/World/Looks/{name}")
        shader = UsdShade.Shader.Define(stage, f"/World/Looks/{name}/Surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.25)
        material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
        if name == "Blue":
            folder = os.path.dirname(stage.GetRootLayer().realPath)
            with open(os.path.join(folder, "blue.png"), "wb") as picture:
                picture.write(b"\x89PNG\r\n\x1a\n")
            texture = UsdShade.Shader.Define(stage, f"/World/Looks/{name}/Picture")
            texture.CreateIdAttr("UsdUVTexture")
            texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set("./blue.png")
            color = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
            color.ConnectToSource(texture.ConnectableAPI(), "rgb")
    api = UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim())
    api.Bind(UsdShade.Material.Get(stage, "/World/Looks/Red"))
    subset = api.CreateMaterialBindSubset("sides", [0, 1])
    UsdShade.MaterialBindingAPI.Apply(subset.GetPrim()).Bind(UsdShade.Material.Get(stage, "/World/Looks/Blue"))


def skinned(stage, mesh):
    skeleton = UsdSkel.Skeleton.Define(stage, "/World/Skeleton")
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().AddTarget(skeleton.GetPath())
    count = len(mesh.GetPointsAttr().Get())
    binding.CreateJointIndicesPrimvar(False, 1).Set([0] * count)
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * count)
