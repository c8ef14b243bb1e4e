"""Primvars of USD as attributes of a mesh of triangles."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Optional

from .._errors import note, warn
from . import Origin
from ._faces import Column, Triangles, turned_normals

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

DOMAINS = {"vertex": "vertex", "varying": "vertex", "uniform": "face", "faceVarying": "corner", "constant": "constant"}
FIRST_UV = ("st", "uv", "UVMap", "map1", "st0", "st_0")
MAX_COMPONENTS = 4
TAKEN = ("displayColor", "displayOpacity", "normals")


def add_columns(pxr: Any, prim: Any, time: Any, rows: Array, triangles: Triangles, origin: Origin) -> None:
    """Everything that a mesh prim has beside its positions; what fits nothing is left out, and a warning says so."""
    primvars = {p.GetPrimvarName(): p for p in pxr.UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance()
                if p.HasValue()}
    _add_color(primvars, time, triangles, origin)
    _add_normals(pxr, prim, primvars, time, rows, triangles)
    sets = _uv_sets(primvars)
    for name in sets + sorted(set(primvars) - set(sets)):
        if name in TAKEN or name.startswith("skel:"):
            continue
        primvar = primvars[name]
        column = _column_of(primvar, time, triangles)
        if column is None:
            continue
        if name in sets:
            triangles.columns[_uv_name(name, name == sets[0], origin)] = column
        else:
            _add_plain(name, column, str(primvar.GetTypeName()), triangles, origin)


def _add_plain(name: str, column: Column, type_name: str, triangles: Triangles, origin: Origin) -> None:
    """A name that has a meaning of its own gets another; values of several numbers come apart."""
    if is_of_corners(name) or name in ("color", "material", "texnumber", "gap"):
        name += "_"
    if column.domain == "constant":
        origin.constants.add(name)
    if column.values.shape[1] == 1 or column.labels:
        triangles.columns[name] = column
        return
    origin.vectors[name] = type_name
    for i in range(column.values.shape[1]):
        triangles.columns[f"{name}.{i}"] = Column(column.values[:, i:i + 1], column.domain)


def is_of_corners(name: str) -> bool:
    """Whether an attribute is one of those that may differ between the faces around a vertex."""
    return re.fullmatch(r"uv\d*|normal", name) is not None


def _uv_sets(primvars: dict[str, Any]) -> list[str]:
    """Texture coordinates by their names and types; first those that materials use first."""
    typed, flat = [], []
    for name, primvar in sorted(primvars.items()):
        kind = str(primvar.GetTypeName()).removesuffix("[]")
        if kind in ("texCoord2f", "texCoord2d", "texCoord2h"):
            typed.append(name)
        elif kind in ("float2", "double2", "half2"):
            if name in FIRST_UV or primvar.GetInterpolation() == "faceVarying":
                flat.append(name)
    return sorted(typed + flat, key=lambda name: FIRST_UV.index(name) if name in FIRST_UV else len(FIRST_UV))


def _uv_name(primvar: str, is_first: bool, origin: Origin) -> str:
    """The attribute that a set becomes, the same in all meshes."""
    if is_first:
        origin.uv_sets[:1] = origin.uv_sets[:1] or [primvar]
        return "uv"
    if primvar not in origin.uv_sets[1:]:
        origin.uv_sets[:] = (origin.uv_sets or [primvar]) + [primvar]
    return f"uv{origin.uv_sets.index(primvar, 1)}"


def _add_color(primvars: dict[str, Any], time: Any, triangles: Triangles, origin: Origin) -> None:
    import numpy as np

    if "displayColor" not in primvars:
        return
    color = _column_of(primvars["displayColor"], time, triangles)
    if color is None or color.values.shape[1] != 3:
        return
    opacity = _column_of(primvars["displayOpacity"], time, triangles) if "displayOpacity" in primvars else None
    if opacity is not None and opacity.values.shape[1] == 1:
        if opacity.domain == "constant":
            opacity = Column(np.repeat(opacity.values, len(color.values), axis=0), color.domain)
        elif color.domain == "constant":
            color = Column(np.repeat(color.values, len(opacity.values), axis=0), opacity.domain)
        if opacity.domain == color.domain:
            color = Column(np.concatenate([color.values, opacity.values], axis=1), color.domain)
        else:
            warn(f"{triangles.path}: displayOpacity is left out: it is of each {opacity.domain}, and displayColor of "
                 f"each {color.domain}")
    if color.domain == "constant":
        origin.constants.add("color")
    triangles.columns["color"] = Column(color.values.astype(np.float32), color.domain)


def _add_normals(pxr: Any, prim: Any, primvars: dict[str, Any], time: Any, rows: Array, triangles: Triangles) -> None:
    import numpy as np

    mesh = pxr.UsdGeom.Mesh(prim)
    column: Optional[Column] = None
    if "normals" in primvars:
        column = _column_of(primvars["normals"], time, triangles)
    elif mesh.GetNormalsAttr().Get(time):
        values = np.array(mesh.GetNormalsAttr().Get(time), np.float64)
        column = _checked("normals", values, str(mesh.GetNormalsInterpolation()), triangles)
    if column is not None and column.values.shape[1] == 3:
        normals = turned_normals(column.values.astype(np.float64), rows)
        triangles.columns["normal"] = Column(normals.astype(np.float32), column.domain)


def _column_of(primvar: Any, time: Any, triangles: Triangles) -> Optional[Column]:
    import numpy as np

    name, value = str(primvar.GetPrimvarName()), primvar.Get(time)
    if value is None:
        return None
    if primvar.GetElementSize() != 1:
        return _left_out(name, triangles, f"elements of {primvar.GetElementSize()} values are not read")
    labels: list[str] = []
    if str(primvar.GetTypeName()).rstrip("[]") in ("string", "token"):
        texts = [value] if isinstance(value, str) else list(value)
        labels = sorted({text for text in texts if text})
        number = {text: i for i, text in enumerate(labels)}
        values = np.array([number.get(text, -1) for text in texts], np.int32)
    else:
        values = np.array(value)
        if not primvar.GetTypeName().isArray:
            values = values[None]
    are_numbers = values.dtype.kind in "biuf" and not str(primvar.GetTypeName()).startswith("quat")
    if not are_numbers or values.ndim > 2 or (values.ndim == 2 and values.shape[1] > MAX_COMPONENTS):
        return _left_out(name, triangles, f"values of the type {primvar.GetTypeName()} are not read")
    if primvar.IsIndexed():
        indices = np.array(primvar.GetIndices(time) or [], np.int64)
        if np.any((indices < 0) | (indices >= len(values))):
            return _left_out(name, triangles, f"its indices name a value that is none of its {len(values)}")
        values = values[indices]
    column = _checked(name, _storable(values), str(primvar.GetInterpolation()), triangles)
    if column is not None:
        column.labels = labels
    if labels and column is not None and column.domain not in ("face", "constant"):
        return _left_out(name, triangles, "texts are kept where they are of faces")
    return column


def _storable(values: Array) -> Array:
    """Values in one of the types that attributes have."""
    import numpy as np

    if values.dtype.kind == "b":
        return values.astype(np.uint8)
    if values.dtype == np.float16:
        return values.astype(np.float32)
    if values.dtype.itemsize == 8 and values.dtype.kind in "iu":
        small = values.astype(np.int32)
        return small if np.array_equal(small, values) else values.astype(np.float64)
    return values


def _checked(name: str, values: Array, interpolation: str, triangles: Triangles) -> Optional[Column]:
    domain = DOMAINS.get(interpolation, "constant")
    needed = {"vertex": len(triangles.points), "face": triangles.face_count, "corner": triangles.corner_count,
              "constant": 1}[domain]
    if len(values) != needed:
        return _left_out(name, triangles, f"it has {len(values)} values, and {interpolation} takes {needed}")
    return Column(values.reshape(needed, -1), domain)


def _left_out(name: str, triangles: Triangles, why: str) -> Optional[Column]:
    warn(f"{triangles.path}: the primvar {name} is left out: {why}")
    return None


def joined_columns(meshes: list[Triangles]) -> list[tuple[str, str, Array, list[str]]]:
    """One attribute for all meshes: name, domain, values, labels. What a mesh does not have, is white or 0 there."""
    import numpy as np

    joined = []
    for name in sorted({name for mesh in meshes for name in mesh.columns}):
        found = _of_one_kind([mesh.columns.get(name) for mesh in meshes])
        domain = _common_domain(name, [column.domain for column in found if column])
        width = max(column.values.shape[1] for column in found if column)
        labels = sorted({label for column in found if column for label in column.labels})
        parts = []
        for mesh, column in zip(meshes, found):
            if column is None:
                part = np.full((_count(mesh, domain), width), _missing(name, labels))
                present = next(c for c in found if c)
                parts.append(part.astype(present.values.dtype))
                continue
            values = _padded(_renumbered(column, labels), width)
            parts.append(_in_domain(name, mesh, Column(values, column.domain), domain))
        values = np.concatenate(parts)
        if domain == "corner":
            values = values.reshape(-1, 3, width)
        joined.append((name, domain, values, labels))
    return joined


def _of_one_kind(columns: list[Optional[Column]]) -> list[Optional[Column]]:
    """Where some meshes have names, numbers of others mean nothing."""
    if any(column and column.labels for column in columns):
        return [column if column and column.labels else None for column in columns]
    return columns


def _common_domain(name: str, domains: list[str]) -> str:
    if is_of_corners(name):
        return "corner"
    given = set(domains) - {"constant"}
    if not given or given == {"face"}:
        return "face"
    return "vertex"


def _count(mesh: Triangles, domain: str) -> int:
    return {"vertex": len(mesh.points), "face": len(mesh.faces), "corner": 3 * len(mesh.faces)}[domain]


def _missing(name: str, labels: list[str]) -> float:
    if is_of_corners(name):
        return float("nan")
    if labels:
        return -1
    return 1 if name == "color" else 0


def _renumbered(column: Column, labels: list[str]) -> Array:
    import numpy as np

    if not column.labels:
        return column.values
    numbers = np.array([*map(labels.index, column.labels), -1], np.int32)
    return numbers[column.values]


def _padded(values: Array, width: int) -> Array:
    """Colours without opacity beside some that have it are opaque."""
    import numpy as np

    missing = width - values.shape[1]
    return np.concatenate([values, np.ones((len(values), missing), values.dtype)], axis=1) if missing > 0 else values


def _in_domain(name: str, mesh: Triangles, column: Column, domain: str) -> Array:
    """Values of the triangles, or of their vertices."""
    import numpy as np

    if column.domain == "constant":
        return np.repeat(column.values, _count(mesh, domain), axis=0)
    if column.domain == "vertex" and domain == "vertex":
        return column.values
    if column.domain == "face" and domain == "face":
        return column.values[mesh.face_of]
    corners = {"vertex": mesh.faces, "face": np.repeat(mesh.face_of[:, None], 3, axis=1),
               "corner": mesh.corner_of}[column.domain].reshape(-1)
    of_corners = column.values[corners]
    return of_corners if domain == "corner" else _of_vertices(name, mesh, of_corners)


def _of_vertices(name: str, mesh: Triangles, of_corners: Array) -> Array:
    """Values of corners for vertices: the mean of those that meet there."""
    import numpy as np

    at = mesh.faces.reshape(-1)
    values = np.zeros((len(mesh.points), of_corners.shape[1]), of_corners.dtype)
    values[at] = of_corners
    if np.array_equal(values[at], of_corners):
        return values
    if of_corners.dtype.kind != "f":
        warn(f"{mesh.path}: the primvar {name} jumps between faces, and only values of whole faces, uv and normals "
             "may: each vertex has the value of one of its faces")
        return values
    note(f"{mesh.path}: the primvar {name} jumps between faces: each vertex has the mean of its faces")
    counts = np.maximum(np.bincount(at, minlength=len(values)), 1)
    means = [np.bincount(at, weights=of_corners[:, i], minlength=len(values)) / counts for i in range(values.shape[1])]
    return np.column_stack(means).astype(of_corners.dtype)


def base_of(name: str) -> tuple[str, int]:
    """The name and number of a component; -1 where it is none."""
    found = re.fullmatch(r"(.+)\.(\d+)", name)
    return (found[1], int(found[2])) if found else (name, -1)
