"""A result as packages have meshes whose attributes are of vertices and of faces, and not of the corners of faces."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from .._inputs import Mesh
from .._sources import named_of

if TYPE_CHECKING:
    import numpy as np

    from .._result import Result

    Array = np.ndarray[Any, np.dtype[Any]]


class Given(NamedTuple):
    """Copies of all that there is."""

    vertices: Array
    faces: Array
    of_vertices: dict[str, Array]  # texture coordinates and normals among them
    of_faces: dict[str, Array]  # region_inside and region_outside among them
    notes: dict[str, Any]  # names of regions and of labels, by what Taker.add_names finds them


def given_of(made: Result | Mesh, splits: bool = True) -> Given:
    """Vertices with several texture coordinates or normals are there once for each, next to each other; or, unless it
    splits, these are of faces: (M, 3, ...)."""
    import numpy as np

    named = named_of(made)
    vertices, faces = np.array(made.vertices, np.float64), np.array(made.faces)
    corners = {name: values for name, domain, values, _ in named if domain == "corner"}
    of_vertices: dict[str, Array] = {}
    vertex_of = np.arange(len(vertices))
    if corners and splits:
        first, vertex_of, faces = _split(faces, corners)
        of_vertices = {name: values.reshape(-1, values.shape[-1])[first] for name, values in corners.items()}
    of_vertices = {**{name: np.array(values)[vertex_of] for name, domain, values, _ in named if domain == "vertex"},
                   **of_vertices}
    of_faces = {name: np.array(values) for name, domain, values, _ in named
                if domain == "face" or (domain == "corner" and not splits)}
    notes: dict[str, Any] = {f"{name}_names": labels for name, _, _, labels in named if labels}
    regions = made.regions
    if regions and len(regions["labels"]):
        of_faces["region_inside"], of_faces["region_outside"] = np.array(regions["labels"], np.int32).T.copy()
        notes["region_background"] = [int(regions.get("background", 0))]
        names = regions.get("names") or {}
        notes["region_numbers"] = [int(label) for label in names]
        notes["region_names"] = list(names.values())
    return Given(vertices[vertex_of], faces, _with_vectors(of_vertices), _with_vectors(of_faces), notes)


def _split(faces: Array, corners: dict[str, Array]) -> tuple[Array, Array, Array]:
    """Of each new vertex a corner that it stands for, and its old vertex; and the faces of new ones."""
    import numpy as np

    columns = [np.asarray(faces, np.int64).reshape(-1, 1)]
    for values in corners.values():
        rows = np.ascontiguousarray(values.reshape(-1, values.shape[-1]), np.float64) + 0.0  # there is one zero
        columns.append(np.where(np.isnan(rows), np.nan, rows).view(np.int64))
    rows, first, of_corner = np.unique(np.column_stack(columns), axis=0, return_index=True, return_inverse=True)
    return first, rows[:, 0], of_corner.reshape(-1, 3).astype(faces.dtype)


def _with_vectors(attributes: dict[str, Array]) -> dict[str, Array]:
    """Numbers that came apart into name.0, name.1 and so on, as one again."""
    import numpy as np

    joined: dict[str, Any] = {}
    for name, values in attributes.items():
        found = re.fullmatch(r"(.+)\.(\d+)", name)
        base, number = (found[1], int(found[2])) if found else (name, 0)
        columns = joined.get(base)
        if found and number == 0 and base not in attributes:
            joined[base] = [values]
        elif found and isinstance(columns, list) and len(columns) == number:
            columns.append(values)
        else:
            joined[name] = values
    return {name: np.column_stack(values) if isinstance(values, list) else values for name, values in joined.items()}
