"""Attributes of a result as primvars of USD."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._result import Result
from ._usd import Origin
from ._usd_primvars import base_of, is_of_corners

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

INTERPOLATIONS = {"vertex": "vertex", "face": "uniform", "corner": "faceVarying"}


def add_primvars(pxr: Any, mesh: Any, result: Result, origin: Origin) -> None:
    """Everything that the result has beside its positions, but for materials."""
    api = pxr.UsdGeom.PrimvarsAPI(mesh.GetPrim())
    vectors: dict[tuple[str, str], list[Array]] = {}
    for key, domain, values, labels in result._named_attributes():
        name = key.removesuffix(f":{domain}")
        base, component = base_of(name)
        if key != name:  # the second attribute of that name
            if values.ndim == 1:
                _add_numbers(pxr, api, f"{name}_{domain}", domain, values, origin)
        elif name == "color":
            _add_color(pxr, api, domain, values, origin)
        elif name == "normal":
            _add_normals(pxr, mesh, result, values)
        elif is_of_corners(name):
            _add_uv(pxr, api, values, _uv_set_of(name, origin))
        elif name == "material" and labels:
            continue
        elif component >= 0 and base in origin.vectors:
            vectors.setdefault((base, domain), []).append(values)
        elif labels:
            _add_texts(pxr, api, name, domain, values, labels)
        else:
            _add_numbers(pxr, api, name, domain, values, origin)
    for (name, domain), columns in vectors.items():
        _add_vectors(pxr, api, name, domain, columns, origin)


def _create(pxr: Any, api: Any, name: str, type_name: Any, interpolation: str) -> Any:
    return api.CreatePrimvar(":".join(map(pxr.Tf.MakeValidIdentifier, name.split(":"))), type_name, interpolation)


def _of_all(name: str, domain: str, values: Array, origin: Origin) -> tuple[str, Array]:
    """The interpolation; one value where the source has one and all are the same."""
    if name in origin.constants and len(values) > 0 and bool((values == values[:1]).all()):
        return "constant", values[:1]
    return INTERPOLATIONS[domain], values


def _add_color(pxr: Any, api: Any, domain: str, values: Array, origin: Origin) -> None:
    import numpy as np

    colors = values.astype(np.float32)
    if values.dtype.kind in "iu":
        colors = colors / np.float32(np.iinfo(values.dtype).max)
    interpolation, colors = _of_all("color", domain, colors, origin)
    names = pxr.Sdf.ValueTypeNames
    _create(pxr, api, "displayColor", names.Color3fArray, interpolation).Set(
        pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(colors[:, :3])))
    if colors.shape[1] == 4:
        _create(pxr, api, "displayOpacity", names.FloatArray, interpolation).Set(
            pxr.Vt.FloatArray.FromNumpy(np.ascontiguousarray(colors[:, 3])))


def _uv_set_of(name: str, origin: Origin) -> str:
    number = int(name.removeprefix("uv") or 0)
    return origin.uv_sets[number] if number < len(origin.uv_sets) else f"st{number or ''}"


def _add_uv(pxr: Any, api: Any, values: Array, name: str) -> None:
    """One value for all corners that share it, so that the seams of a map are those of its indices."""
    import numpy as np

    rows = np.nan_to_num(values.reshape(-1, 2).astype(np.float32))
    kept, indices = np.unique(rows, axis=0, return_inverse=True)
    primvar = _create(pxr, api, name, pxr.Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying")
    primvar.Set(pxr.Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(kept)))
    primvar.SetIndices(pxr.Vt.IntArray.FromNumpy(indices.reshape(-1).astype(np.int32)))


def _add_normals(pxr: Any, mesh: Any, result: Result, values: Array) -> None:
    """Where the source has none, those of the faces."""
    import numpy as np

    normals = values.astype(np.float32)
    missing = np.asarray(~np.isfinite(normals).all(axis=2))
    if missing.any():
        a, b, c = (result.vertices[result.faces[:, i]] for i in range(3))
        across = np.cross(b - a, c - a)
        across /= np.maximum(np.linalg.norm(across, axis=1), np.finfo(float).tiny)[:, None]
        normals = np.where(missing[:, :, None], across[:, None, :], normals).astype(np.float32)
    mesh.CreateNormalsAttr(pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(normals.reshape(-1, 3))))
    mesh.SetNormalsInterpolation(pxr.UsdGeom.Tokens.faceVarying)


def _add_texts(pxr: Any, api: Any, name: str, domain: str, values: Array, labels: list[str]) -> None:
    import numpy as np

    indices = np.where((values >= 0) & (values < len(labels)), values, len(labels)).astype(np.int32)
    texts = labels + [""] if np.any(indices == len(labels)) else labels
    primvar = _create(pxr, api, name, pxr.Sdf.ValueTypeNames.StringArray, INTERPOLATIONS[domain])
    primvar.Set(pxr.Vt.StringArray(texts))
    primvar.SetIndices(pxr.Vt.IntArray.FromNumpy(indices))


def _add_numbers(pxr: Any, api: Any, name: str, domain: str, values: Array, origin: Origin) -> None:
    import numpy as np

    names, arrays = pxr.Sdf.ValueTypeNames, pxr.Vt
    kinds = {"f4": (names.FloatArray, arrays.FloatArray, np.float32),
             "f8": (names.DoubleArray, arrays.DoubleArray, np.float64),
             "u1": (names.UCharArray, arrays.UCharArray, np.uint8),
             "u4": (names.UIntArray, arrays.UIntArray, np.uint32)}
    type_name, array, dtype = kinds.get(values.dtype.str[1:], (names.IntArray, arrays.IntArray, np.int32))
    interpolation, values = _of_all(name, domain, values, origin)
    _create(pxr, api, name, type_name, interpolation).Set(array.FromNumpy(np.ascontiguousarray(values, dtype)))


def _add_vectors(pxr: Any, api: Any, name: str, domain: str, columns: list[Array], origin: Origin) -> None:
    """In the source's type; where a run kept some of the numbers only, each by itself."""
    import numpy as np

    type_name = pxr.Sdf.ValueTypeNames.Find(origin.vectors[name].removesuffix("[]") + "[]")
    array = type_name.type.pythonClass
    row = np.array(array(1))
    if row.shape[1] != len(columns):
        for i, column in enumerate(columns):
            _add_numbers(pxr, api, f"{name}_{i}", domain, column, origin)
        return
    interpolation, values = _of_all(name, domain, np.column_stack(columns), origin)
    _create(pxr, api, name, type_name, interpolation).Set(array.FromNumpy(np.ascontiguousarray(values, row.dtype)))
