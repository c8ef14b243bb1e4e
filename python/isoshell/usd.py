"""Scenes of USD: meshes in, and results with their volumes out. Needs usd-core: pip install 'isoshell[usd]'.

    result = isoshell.remesh("scene.usda")                 # every mesh that is seen
    result = isoshell.remesh("scene.usda:/World/Mesh")     # that prim, and what is below it
    result = isoshell.remesh(isoshell.usd.read("scene.usda", "/World/Mesh", time=24))
    result.save("out.usda")                                # or .usdc, or .usdz
    isoshell.usd.write("out.usda", result, volumes=["out.shell.vdb", "out.voronoi.vdb"])

Points are in the stage's world: transforms are applied, in double precision, and nothing else is done to them. The up
axis and the unit are passed on.
"""

from __future__ import annotations

import os
from typing import Any, Optional, Sequence

from ._errors import Error
from ._isoshell import ErrorCode
from ._sources import Mesh
from ._usd import Origin, is_usd, library, split_name
from ._usd_faces import Triangles, rows_of, triangles_of
from ._usd_materials import Materials
from ._usd_primvars import add_columns, joined_columns
from ._usd_scene import meshes_of, note, open_stage, reading, root_of, time_of
from ._usd_write import write

__all__ = ["Origin", "is_usd", "read", "write"]


def read(path: str | os.PathLike[str], prim: Optional[str] = None, *, time: Optional[float] = None,
         purposes: Sequence[str] = ("default", "render")) -> Mesh:
    """The meshes of a stage as one source, with instances and references resolved.

    Polygons are split as those of any other file, faces of holeIndices left out, left-handed and mirrored meshes turned
    so that their outside stays outside. Subdivision surfaces are read as their cages. Primvars are attributes:
    displayColor and displayOpacity are color, the first set of texture coordinates uv, normals normal, bound materials
    and those of subsets material; values of two to four numbers come apart into name.0, name.1 and so on.

    Args:
        path: a file, perhaps with a prim: FILE.usda:/World/Mesh.
        prim: what to read: a mesh, seen or not, or the meshes below; all of the stage without it.
        time: time code; without it the one that the stage starts with.
        purposes: of the meshes to read where several are.

    Raises:
        Error: of code UNREADABLE_INPUT for a file that cannot be read or contradicts itself, NOTHING_TO_MESH without a
            mesh that is seen, USAGE for a prim that is not there and without usd-core.
    """
    pxr = library()
    file, named = split_name(path)
    with reading(pxr, file):
        made = _read(pxr, file, prim if prim is not None else named, time, purposes)
    made.name = os.fsdecode(path) if prim is None else f"{file}:{prim}"
    return made


def _read(pxr: Any, file: str, prim: Optional[str], time: Optional[float], purposes: Sequence[str]) -> Mesh:
    import numpy as np

    stage = open_stage(pxr, file)
    root = root_of(pxr, stage, file, prim)
    code = time_of(pxr, stage, time)
    materials = Materials(pxr, code)
    origin = _origin_of(pxr, stage)
    meshes: list[Triangles] = []
    cages = 0
    placed = meshes_of(pxr, file, root, code, purposes)
    for mesh, matrix in placed:
        triangles = triangles_of(pxr, mesh, matrix, code)
        add_columns(pxr, mesh, code, rows_of(triangles.path, matrix), triangles, origin)
        materials.add_column(mesh, triangles)
        meshes.append(triangles)
        cages += pxr.UsdGeom.Mesh(mesh).GetSubdivisionSchemeAttr().Get(code) != pxr.UsdGeom.Tokens.none
    if cages:
        note(f"{file}: {cages} of {len(placed)} meshes are subdivision surfaces, read as their cages")
    if not any(len(mesh.faces) for mesh in meshes):
        raise Error(f"{file}: its meshes have no face that can be used", ErrorCode.NOTHING_TO_MESH, "read")
    if len(placed) == 1:
        origin.name = str(placed[0][0].GetName())
    origin.materials = materials.text()
    made = Mesh(np.concatenate([mesh.points for mesh in meshes]), _joined_faces(meshes))
    for name, domain, values, labels in joined_columns(meshes):
        {"vertex": made.of_vertices, "face": made.of_faces, "corner": made.of_corners}[domain][name] = _flat(values)
        if labels:
            made.labels[name] = labels
    made.origin = origin
    return made


def _flat(values: Any) -> Any:
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def _joined_faces(meshes: list[Triangles]) -> Any:
    import numpy as np

    parts, first = [], 0
    for mesh in meshes:
        parts.append(mesh.faces + first)
        first += len(mesh.points)
    return np.concatenate(parts)


def _origin_of(pxr: Any, stage: Any) -> Origin:
    root = stage.GetDefaultPrim()
    return Origin(up_axis=str(pxr.UsdGeom.GetStageUpAxis(stage)),
                  meters_per_unit=float(pxr.UsdGeom.GetStageMetersPerUnit(stage)),
                  root=str(root.GetName()) if root else "World")
