"""A stage of USD that stays open, and its meshes at any of its times as sources."""

from __future__ import annotations

import os
from typing import Any, Optional, Sequence, Union

from .._errors import Error, note, warn
from .._isoshell import ErrorCode
from .._inputs import Mesh
from .._labels import joined_regions
from .._paths import path_text
from . import Origin, library, split_name
from ._faces import Triangles, rows_of, triangles_of
from ._materials import Materials
from ._primvars import add_columns, joined_columns
from ._regions import read_names, read_regions
from ._scene import is_skinned, meshes_of, open_stage, reading, root_of, sampled_times, time_of

PURPOSES = ("default", "render")


class Scene:
    """What isoshell.usd.read names, opened once."""

    def __init__(self, path: str | os.PathLike[str], prim: Optional[str] = None,
                 purposes: Sequence[str] = PURPOSES) -> None:
        self._pxr = library()
        self._file, named = split_name(path)
        self._name = path_text(path) if prim is None else f"{self._file}:{prim}"
        self._purposes = purposes
        self._has_warned = False
        with reading(self._pxr, self._file):
            self._stage = open_stage(self._pxr, self._file)
            self._root = root_of(self._pxr, self._stage, self._file, prim if prim is not None else named)

    def times(self) -> list[Union[int, float]]:
        """The time codes of all samples that the meshes have, and their transforms; whole ones are int."""
        with reading(self._pxr, self._file):
            times = sampled_times(self._pxr, self._root)
        return [int(time) if time == int(time) else time for time in times]

    def mesh_at(self, time: Optional[float], until: Optional[float] = None) -> Mesh:
        """The meshes at a time code; at that which the stage starts with where it is None. With velocities, where they
        have some, until another.

        Raises:
            Error: as isoshell.usd.read does.
        """
        with reading(self._pxr, self._file):
            made, meshes = self._mesh_at(time_of(self._pxr, self._stage, time))
            if time is not None and until is not None:
                made.velocities = _velocities_of(meshes, (until - time) / self._stage.GetTimeCodesPerSecond())
        made.name = self._name
        return made

    def _mesh_at(self, code: Any) -> tuple[Mesh, list[Triangles]]:
        import numpy as np

        pxr, file = self._pxr, self._file
        materials = Materials(pxr, code)
        origin = self._origin()
        meshes: list[Triangles] = []
        cages = 0
        placed = meshes_of(pxr, file, self._root, code, self._purposes)
        self._warn_of_skins([mesh for mesh, _ in placed])
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
        made.regions = joined_regions(file, [self._regions_of(mesh, triangles, code)
                                             for (mesh, _), triangles in zip(placed, meshes) if len(triangles.faces)])
        return made, meshes

    def _regions_of(self, mesh: Any, triangles: Triangles, code: Any) -> Optional[dict[str, Any]]:
        """Those that a mesh was written with."""
        labels = read_regions(self._pxr, mesh, code, triangles.face_count)
        if labels is None:
            return None
        background, names = read_names(self._pxr, mesh)
        return {"labels": labels[triangles.face_of], "background": background, "names": names}

    def _warn_of_skins(self, meshes: list[Any]) -> None:
        """Once, however many times are read."""
        if self._has_warned:
            return
        paths = sorted({str(mesh.GetPath()) for mesh in meshes if is_skinned(self._pxr, mesh)})
        if paths:
            self._has_warned = True
            others = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
            warn(f"{self._file}: {paths[0]}{others} moves with a skeleton or blend shapes, which are not read: the mesh "
                 "is taken as it rests; bake it before, as UsdSkel.BakeSkinning does")

    def _origin(self) -> Origin:
        root, geometry = self._stage.GetDefaultPrim(), self._pxr.UsdGeom
        return Origin(up_axis=str(geometry.GetStageUpAxis(self._stage)),
                      meters_per_unit=float(geometry.GetStageMetersPerUnit(self._stage)),
                      root=str(root.GetName()) if root else "World",
                      time_codes_per_second=float(self._stage.GetTimeCodesPerSecond()))


def _flat(values: Any) -> Any:
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def _velocities_of(meshes: list[Triangles], seconds: float) -> Any:
    """Over so long a time; NaN of meshes that have none, and None where no mesh has."""
    import numpy as np

    if all(mesh.velocities is None for mesh in meshes):
        return None
    parts = [np.full((len(mesh.points), 3), np.nan) if mesh.velocities is None else mesh.velocities for mesh in meshes]
    return np.concatenate(parts) * seconds


def _joined_faces(meshes: list[Triangles]) -> Any:
    import numpy as np

    parts, first = [], 0
    for mesh in meshes:
        parts.append(mesh.faces + first)
        first += len(mesh.points)
    return np.concatenate(parts)
