"""A result as a stage of USD, with the volumes that belong to it."""

from __future__ import annotations

import os
import tempfile
from typing import TYPE_CHECKING, Any, Iterable, Optional, Sequence, Union

from .. import _isoshell
from .._errors import Error, warn
from .._isoshell import VERSION, ErrorCode
from .._keywords import text_of
from .._paths import path_text, unwritable, writing
from .._result import Result
from .._vdb_header import Box, Grid, grids_of
from . import Origin, library, reason_of, split_name
from ._attributes import PrimvarWriter
from ._materials import relative_asset, write_materials
from ._regions import write_regions

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

FIELD_TYPES = {"float": "float", "double": "double", "int32": "int", "int64": "int64", "bool": "bool",
               "vec3s": "float3", "vec3d": "double3", "vec3i": "int3"}
CLASSES = {"level set": "levelSet", "fog volume": "fogVolume", "staggered": "staggered"}
VECTOR_ROLES = {"closest_offset": "Vector", "color": "Color"}
MATERIALS = "Materials"  # below the root
FAR = 64  # sizes of itself from the origin: beyond, single precision takes more than a millionth of the size


def check_target(path: str, overwrite: bool, volumes: Iterable[str] = (),
                 others: Iterable[tuple[str, str]] = (), inputs: Iterable[tuple[str, str]] = ()) -> None:
    """Before a run: whether its result could be written there, beside its other files and those that it reads.

    Raises:
        Error: of code UNWRITABLE_OUTPUT or USAGE.
    """
    library()
    file, prim = split_name(path)
    if prim is not None:
        raise Error(f"{path}: a prim is named; give the file alone", stage="write")
    _isoshell.check_output_files([("OUTPUT", file), *others], list(inputs), overwrite)
    if file.lower().endswith(".usdz") and list(volumes):
        raise Error(f"{file}: packages hold no volumes; give a .usda or .usdc", stage="write")


def write(path: str | os.PathLike[str], result: Result, *, volumes: Iterable[str | os.PathLike[str]] = (),
          up_axis: Optional[str] = None, meters_per_unit: Optional[float] = None, overwrite: bool = False,
          recenter: Union[str, Sequence[float], None] = None) -> None:
    """Write a result as a stage: a mesh with its attributes as primvars, materials, and volumes where they belong.

    Args:
        path: .usda (text), .usdc or .usd (binary), or .usdz (a package, without volumes).
        result: what to write.
        volumes: OpenVDB files, such as those of save_shell and save_voronoi; their paths are written relative to the
            stage's, and each is a Volume of as many fields as it has grids.
        up_axis: "Y" or "Z"; without it the source's, or Y.
        meters_per_unit: without it the source's, or 1.
        overwrite: replace a file that is there.
        recenter: three numbers that are subtracted from the points, or "auto", which takes round ones near the middle
            of the mesh; a RunWarning and the stage's comment name them. Without it a mesh far from the origin has a
            transform, which takes it there.

    Raises:
        Error: of code UNWRITABLE_OUTPUT when it cannot be written, or is there, or the points, which are 32-bit floats,
            do not hold the triangles; UNREADABLE_INPUT for what is no OpenVDB
            file; USAGE without usd-core.
    """
    import numpy as np

    pxr = library()
    target = path_text(path)
    files = [path_text(volume) for volume in volumes]
    check_target(target, overwrite, files)
    origin = result.origin or Origin()
    axis = origin.up_axis if up_axis is None else up_axis
    if axis not in ("Y", "Z"):
        raise Error(f"up_axis is {axis!r}; it must be 'Y' or 'Z'", stage="write")
    unit = origin.meters_per_unit if meters_per_unit is None else meters_per_unit
    if not 0 < unit < float("inf"):
        raise Error(f"meters_per_unit is {unit!r}; it must be above 0", stage="write")
    folder = os.path.dirname(os.path.abspath(target))
    grids = [grids_of(file) for file in files]

    stage = pxr.Usd.Stage.CreateInMemory()
    root = begin_stage(pxr, stage, origin, axis, unit)
    names: set[str] = {MATERIALS}
    place = result._made.offset(text_of("recenter", recenter))
    mesh = define_mesh(pxr, stage, _free(pxr, root, origin.name, names), result, place is None)
    if place is not None:
        shown = " ".join(f"{number:.17g}" for number in place)
        stage.GetRootLayer().comment += f", offset {shown}"
        warn(f"{target}: {shown} is subtracted from the positions; add it to have them where the input is")
    offset = offset_of(result.vertices) if place is None else np.array(place)
    write_shape(pxr, mesh, result, offset, pxr.Usd.TimeCode.Default())
    PrimvarWriter(pxr, mesh, origin).write(result)
    _write_materials(pxr, stage, root.GetPath().AppendChild(MATERIALS), mesh, result, origin, folder)
    write_regions(pxr, mesh, result)
    for file, of_file in zip(files, grids):
        name = os.path.basename(file).removesuffix(".vdb").split(".")[-1]
        _write_volume(pxr, stage, _free(pxr, root, name, names), file, of_file, folder)
    save_stage(pxr, stage, target, overwrite)


def begin_stage(pxr: Any, stage: Any, origin: Origin, up_axis: str, meters_per_unit: float) -> Any:
    """Says what a stage says of itself. Returns the prim that holds everything."""
    pxr.UsdGeom.SetStageUpAxis(stage, up_axis)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, meters_per_unit)
    stage.GetRootLayer().comment = f"isoshell {VERSION}"
    root = pxr.UsdGeom.Xform.Define(stage, f"/{pxr.Tf.MakeValidIdentifier(origin.root)}")
    stage.SetDefaultPrim(root.GetPrim())
    return root


def _free(pxr: Any, root: Any, name: str, names: set[str]) -> Any:
    """A path below the root that nothing has yet."""
    base = free = pxr.Tf.MakeValidIdentifier(name)
    while free in names:
        free = f"{base}_{len(names)}"
    names.add(free)
    return root.GetPath().AppendChild(free)


def define_mesh(pxr: Any, stage: Any, path: Any, result: Result, is_moved: bool = True) -> Any:
    """A mesh without a shape yet, moved to a place where single precision has room for that of the result, or not."""
    import numpy as np

    mesh = pxr.UsdGeom.Mesh.Define(stage, path)
    offset = offset_of(result.vertices)
    if is_moved and np.any(offset):
        mesh.AddTranslateOp(pxr.UsdGeom.XformOp.PrecisionDouble).Set(pxr.Gf.Vec3d(*map(float, offset)))
    mesh.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
    return mesh


def write_shape(pxr: Any, mesh: Any, result: Result, offset: Array, time: Any) -> None:
    """Points, faces and extent at a time; `offset` is where the mesh stands."""
    import numpy as np

    points = (result.vertices - offset).astype(np.float32)
    _require_held(result, points)
    stored = pxr.Vt.Vec3fArray.FromNumpy(points)
    mesh.CreatePointsAttr().Set(stored, time)
    mesh.CreateFaceVertexCountsAttr().Set(pxr.Vt.IntArray.FromNumpy(np.full(len(result.faces), 3, np.int32)), time)
    mesh.CreateFaceVertexIndicesAttr().Set(
        pxr.Vt.IntArray.FromNumpy(np.ascontiguousarray(result.faces.reshape(-1))), time)
    mesh.CreateExtentAttr().Set(pxr.UsdGeom.PointBased.ComputeExtent(stored), time)


def _require_held(result: Result, points: Array) -> None:
    """No triangle may tilt by more than 60 degrees or lose its area where its corners are rounded to these."""
    import numpy as np

    def normals(at: Array) -> Array:
        a, b, c = (at[result.faces[:, corner]].astype(np.float64) for corner in range(3))
        return np.cross(b - a, c - a)

    before = normals(result.vertices)
    after = normals(points)
    sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    is_lost = np.any(before != 0, axis=1) & ~((sizes > 0) & (2 * np.sum(before * after, axis=1) >= sizes))
    if np.any(is_lost):
        raise Error(f"the points of USD are 32-bit floats, in which {np.sum(is_lost)} triangles tilt by more than 60 "
                    "degrees or lose their area; write PLY or OBJ", ErrorCode.UNWRITABLE_OUTPUT, "write")


def offset_of(points: Array) -> Array:
    """What to take from the points, so that single precision has room for their shape; 0 near the origin."""
    import numpy as np

    if len(points) == 0:
        return np.zeros(3)
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.max(high - low))
    if float(np.max(np.abs([low, high]))) <= FAR * size:
        return np.zeros(3)
    step = 2.0 ** np.ceil(np.log2(size)) if size > 0 else 1.0
    return np.asarray(np.round((low + high) / (2 * step)) * step)


def _write_materials(pxr: Any, stage: Any, scope: Any, mesh: Any, result: Result, origin: Origin, folder: str) -> None:
    import numpy as np

    labels = result.labels.get("material")
    if not labels or result.domains["material"] != "face":
        return
    numbers = result.attributes["material"]
    used = [label for i, label in enumerate(labels) if np.any(numbers == i)]
    if not used:
        return
    materials = write_materials(pxr, stage, scope, used, origin.materials, folder)
    api = pxr.UsdShade.MaterialBindingAPI
    if len(used) == 1 and np.all(numbers == labels.index(used[0])):
        api.Apply(mesh.GetPrim()).Bind(pxr.UsdShade.Material(materials[used[0]]))
        return
    binding = api.Apply(mesh.GetPrim())
    for label in used:
        faces = np.flatnonzero(numbers == labels.index(label)).astype(np.int32)
        subset = binding.CreateMaterialBindSubset(materials[label].GetName(), pxr.Vt.IntArray.FromNumpy(faces))
        api.Apply(subset.GetPrim()).Bind(pxr.UsdShade.Material(materials[label]))
    whole = bool(np.all(numbers >= 0))
    binding.SetMaterialBindSubsetsFamilyType(
        pxr.UsdGeom.Tokens.partition if whole else pxr.UsdGeom.Tokens.nonOverlapping)


def _write_volume(pxr: Any, stage: Any, path: Any, file: str, grids: list[Grid], folder: str) -> None:
    """A volume without a transform of its own: its grids have theirs, to the same world as the mesh."""
    volume = pxr.UsdVol.Volume.Define(stage, path)
    boxes: list[Box] = []
    names: set[str] = set()
    for number, grid in enumerate(grids):
        kind = FIELD_TYPES.get(grid.type.removeprefix("Tree_").split("_")[0])
        if kind is None:
            continue
        name = pxr.Tf.MakeValidIdentifier(grid.name or "density")
        name = f"{name}_{number}" if name in names else name
        names.add(name)
        asset = pxr.UsdVol.OpenVDBAsset.Define(stage, path.AppendChild(name))
        asset.CreateFilePathAttr(pxr.Sdf.AssetPath(relative_asset(os.path.abspath(file), folder)))
        asset.CreateFieldNameAttr(grid.name)
        asset.CreateFieldDataTypeAttr(kind)
        asset.CreateFieldClassAttr(CLASSES.get(grid.grid_class, "unknown"))
        if grid.name in VECTOR_ROLES and kind.endswith("3"):
            asset.CreateVectorDataRoleHintAttr(VECTOR_ROLES[grid.name])
        volume.CreateFieldRelationship(name, asset.GetPath())
        box = grid.box()
        if box is not None:
            boxes.append(box)
    if boxes:
        volume.CreateExtentAttr(pxr.Vt.Vec3fArray.FromNumpy(_extent_of(boxes)))


def _extent_of(boxes: list[Box]) -> Array:
    """The box around boxes, in single precision and not smaller."""
    import numpy as np

    low, high = np.min([box[0] for box in boxes], axis=0), np.max([box[1] for box in boxes], axis=0)
    ends = np.array([low, high], np.float32)
    down, up = np.nextafter(ends[0], np.float32(-np.inf)), np.nextafter(ends[1], np.float32(np.inf))
    return np.array([np.where(ends[0] > low, down, ends[0]), np.where(ends[1] < high, up, ends[1])], np.float32)


def save_stage(pxr: Any, stage: Any, target: str, overwrite: bool) -> None:
    """Under another name first, so that nothing half-written is left. A stage that lies in a binary file gives it away
    where the target is one, too."""
    folder = os.path.dirname(os.path.abspath(target))
    package = target.lower().endswith(".usdz")
    with writing(target, pxr.Tf.ErrorException, reason_of), tempfile.TemporaryDirectory(prefix=".isoshell-", dir=folder) as work:
        name, ending = os.path.splitext(os.path.basename(target))
        made = os.path.join(work, name + (".usdc" if package else ending.lower()))
        if package:
            for attribute in (a for prim in stage.Traverse() for a in prim.GetAttributes()):
                _up_a_folder(pxr, attribute)
        layer = stage.GetRootLayer()
        if layer.realPath and not made.endswith(".usda"):
            layer.Save()
            made = layer.realPath
        elif not layer.Export(made):
            raise unwritable(target, "USD could not write it")
        if package:
            packed = os.path.join(work, "packed.usdz")
            if not pxr.UsdUtils.CreateNewUsdzPackage(pxr.Sdf.AssetPath(made), packed):
                raise unwritable(target, "USD could not pack it")
            made = packed
        _isoshell.put_in_place(made, target, overwrite)


def _up_a_folder(pxr: Any, attribute: Any) -> None:
    """Files are named as seen from the target, and the package is made one folder below it."""
    value = attribute.Get()
    if isinstance(value, pxr.Sdf.AssetPath) and value.path.startswith(("./", "../")):
        attribute.Set(pxr.Sdf.AssetPath("../" + value.path.removeprefix("./")))
