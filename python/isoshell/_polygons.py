"""Faces of any number of corners as triangles, with what each comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _isoshell
from ._errors import Error

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]


def split_polygons(path: str, points: Array, sizes: Array, corners: Array, used: Array) -> tuple[Array, Array]:
    """Per triangle its face and the places of its corners, in the order of the faces; of those that are `used`."""
    import numpy as np

    first = np.cumsum(sizes) - sizes
    simple = np.flatnonzero((sizes == 3) & used)
    corner_of = first[simple][:, None] + np.arange(3)
    polygons = np.flatnonzero((sizes > 3) & used)
    if len(polygons) == 0:
        return simple, corner_of
    in_face = np.repeat(polygons, sizes[polygons])
    starts = np.cumsum(sizes[polygons]) - sizes[polygons]
    at = first[in_face] + np.arange(len(in_face)) - np.repeat(starts, sizes[polygons])
    follows = at + 1
    ends = follows == first[in_face] + sizes[in_face]
    follows[ends] = first[in_face[ends]]
    kept = corners[at] != corners[follows]  # a quad that is closed to a triangle stays one
    at, in_face = at[kept], in_face[kept]
    counts = np.bincount(in_face, minlength=len(sizes))[polygons]
    try:
        split = _isoshell.split_polygons(path, points[corners[at]], counts, np.arange(len(at)))
    except Error as error:
        if error.code != _isoshell.ErrorCode.NOTHING_TO_MESH:
            raise
        split = np.zeros((0, 3), np.int64)
    faces = np.concatenate([simple, in_face[split[:, 0]]])
    order = np.argsort(faces, kind="stable")
    return faces[order], np.concatenate([corner_of, at[split]])[order]
