"""A mesh prim of USD as triangles in world units, checked before anything is made of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Optional

from .._polygons import split_polygons
from . import unreadable

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]


@dataclass
class Column:
    """An attribute of one mesh: a row for each of its elements."""

    values: Array
    domain: str  # "vertex", "face", "corner" or "constant"
    labels: list[str] = field(default_factory=list)  # where values are numbers of names


@dataclass
class Triangles:
    """The triangles of one mesh, and where each comes from."""

    path: str
    points: Array  # (K, 3) float64, world units
    faces: Array  # (M, 3) vertices
    face_of: Array  # (M,): the face of the prim
    corner_of: Array  # (M, 3): the place in faceVertexIndices
    face_count: int
    corner_count: int
    velocities: Optional[Array] = None  # (K, 3), world units a second
    columns: dict[str, Column] = field(default_factory=dict)


def triangles_of(pxr: Any, prim: Any, matrix: Any, time: Any) -> Triangles:
    """The faces of a mesh prim, holes left out, polygons split as readers of mesh files split them.

    Raises:
        Error: of code UNREADABLE_INPUT for what contradicts itself.
    """
    import numpy as np

    mesh = pxr.UsdGeom.Mesh(prim)
    path = str(prim.GetPath())
    stored = values_of(mesh.GetPointsAttr(), time, "f", 3)
    sizes = values_of(mesh.GetFaceVertexCountsAttr(), time)
    corners = values_of(mesh.GetFaceVertexIndicesAttr(), time)
    _check(path, len(stored), sizes, corners)
    rows = rows_of(path, matrix)
    points = placed(stored.astype(np.float64), rows)
    used = np.ones(len(sizes), bool)
    holes = values_of(mesh.GetHoleIndicesAttr(), time)
    if np.any((holes < 0) | (holes >= len(sizes))):
        raise unreadable(path, f"holeIndices name a face that is none of its {len(sizes)}")
    used[holes] = False
    face_of, corner_of = split_polygons(path, points, sizes, corners, used)
    is_left_handed = mesh.GetOrientationAttr().Get(time) == pxr.UsdGeom.Tokens.leftHanded
    if is_left_handed != (determinant(rows) < 0):
        corner_of = corner_of[:, [0, 2, 1]]
    velocities = values_of(mesh.GetVelocitiesAttr(), time, "f", 3)
    return Triangles(path, points, corners[corner_of], face_of, corner_of, len(sizes), len(corners),
                     turned(velocities.astype(np.float64), rows) if len(velocities) == len(points) else None)


def rows_of(path: str, matrix: Any) -> Array:
    """A matrix of USD, which turns rows: three rows of axes and one of the place."""
    import numpy as np

    rows = np.array(matrix, np.float64)
    if not np.all(np.isfinite(rows)):
        raise unreadable(path, "its transform is not finite")
    return rows[:, :3]


def placed(points: Array, rows: Array) -> Array:
    """Points in the world."""
    import numpy as np

    return np.asarray(turned(points, rows) + rows[3])


def turned(vectors: Array, rows: Array) -> Array:
    """Vectors in the world. Sums are written out, so that they are the same on every machine."""
    import numpy as np

    x, y, z = vectors[:, 0:1], vectors[:, 1:2], vectors[:, 2:3]
    return np.asarray(x * rows[0] + y * rows[1] + z * rows[2])


def turned_normals(normals: Array, rows: Array) -> Array:
    """Normals in the world: by the cofactors, which stay what they are where an axis is flat."""
    import numpy as np

    a, b, c = rows[0], rows[1], rows[2]
    cofactors = np.array([_cross(b, c), _cross(c, a), _cross(a, b)])
    if determinant(rows) < 0:
        cofactors = -cofactors
    x, y, z = normals[:, 0:1], normals[:, 1:2], normals[:, 2:3]
    return np.asarray(x * cofactors[0] + y * cofactors[1] + z * cofactors[2])


def determinant(rows: Array) -> float:
    """Below 0 where the transform mirrors."""
    normal = _cross(rows[1], rows[2])
    return float(rows[0][0] * normal[0] + rows[0][1] * normal[1] + rows[0][2] * normal[2])


def _cross(a: Array, b: Array) -> Array:
    import numpy as np

    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def values_of(attribute: Any, time: Any, kinds: str = "iu", width: int = 1) -> Array:
    """A list of whole numbers, or of rows of numbers; empty where there is none.

    Raises:
        Error: of code UNREADABLE_INPUT where the file has something else under that name.
    """
    import numpy as np

    value = attribute.Get(time)
    values = np.zeros((0, width)) if value is None else np.array(value)
    if values.size == 0:
        values = np.zeros((0, width), np.int64)
    elif values.dtype.kind not in kinds or values.shape[1:] != ((width,) if width > 1 else ()):
        raise unreadable(str(attribute.GetPath()), f"its type is {attribute.GetTypeName()}, which no mesh has there")
    return values.reshape(-1, width) if width > 1 else values.reshape(-1).astype(np.int64)


def _check(path: str, vertex_count: int, sizes: Array, corners: Array) -> None:
    import numpy as np

    if np.any(sizes < 0):
        face = int(np.argmax(sizes < 0))
        raise unreadable(path, f"faceVertexCounts[{face}] is {sizes[face]}; counts are not negative")
    if int(sizes.sum()) != len(corners):
        raise unreadable(path, f"its faceVertexCounts sum up to {sizes.sum()}, and it has {len(corners)} "
                               "faceVertexIndices; both must be the same")
    wrong = (corners < 0) | (corners >= vertex_count)
    if np.any(wrong):
        corner = int(np.argmax(wrong))
        raise unreadable(path, f"faceVertexIndices[{corner}] is {corners[corner]} in a mesh of {vertex_count} points; "
                               "indices count from 0 and are below that")
