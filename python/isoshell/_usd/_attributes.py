"""Attributes of results as primvars of USD, of one time or of many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from .._errors import warn
from .._result import Result
from . import Origin
from ._primvars import base_of, is_of_corners

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

VELOCITIES = ("v", "vel", "velocity")
INTERPOLATIONS = {"vertex": "vertex", "face": "uniform", "corner": "faceVarying"}


def velocity_of(result: Result) -> Optional[str]:
    """The vectors of a grid that are velocities by its name; the first of them."""
    return next((name for name in result._vectors_of_grids() if name in VELOCITIES), None)


class PrimvarWriter:
    """Everything that results have beside their positions, but for materials.

    Of a mesh with time samples, each result is one of them, and what it lacks has no value at its time.
    """

    def __init__(self, pxr: Any, mesh: Any, origin: Origin, is_sampled: bool = False) -> None:
        self._pxr = pxr
        self._mesh = mesh
        self._api = pxr.UsdGeom.PrimvarsAPI(mesh.GetPrim())
        self._origin = origin
        self._is_sampled = is_sampled
        self._first: Any = None  # time of the first sample
        self._time = pxr.Usd.TimeCode.Default()
        self._made: dict[str, tuple[Any, str, Any]] = {}  # by name an attribute, its interpolation and type
        self._set: set[str] = set()

    def write(self, result: Result, left_out: tuple[str, ...] = (), time: Optional[float] = None) -> None:
        """The attributes of a result, of a mesh with samples at its time."""
        if self._is_sampled:
            self._time = self._pxr.Usd.TimeCode(time)
            self._first = self._time if self._first is None else self._first
        self._set = set()
        vectors: dict[tuple[str, str], list[Array]] = {}
        of_grids, velocity = result._vectors_of_grids(), velocity_of(result)
        for key, domain, values, labels in result._named_attributes():
            name = key.removesuffix(f":{domain}")
            base, component = base_of(name)
            if key != name:  # the second attribute of that name
                if values.ndim == 1:
                    self._add_numbers(f"{name}_{domain}", domain, values)
            elif name in left_out or name == "material" and labels:
                continue
            elif name == "color":
                self._add_color(domain, values)
            elif name == "normal":
                self._add_normals(result, values)
            elif is_of_corners(name):
                self._add_uv(values, self._uv_set_of(name))
            elif component >= 0 and (base in self._origin.vectors or base in of_grids):
                vectors.setdefault((base, domain), []).append(values)
            elif labels:
                self._add_texts(name, domain, values, labels)
            else:
                self._add_numbers(name, domain, values)
        for (name, domain), columns in vectors.items():
            if name == velocity:
                self._add_velocities(columns)
            else:
                self._add_vectors(name, domain, columns)
        for name in set(self._made) - self._set:
            self._made[name][0].Set(self._pxr.Sdf.ValueBlock(), self._time)

    def _put(self, name: str, type_name: Any, interpolation: str, values: Any, indices: Optional[Array] = None) -> None:
        """A primvar at this time; it keeps the type and interpolation of its first."""
        pxr = self._pxr
        name = ":".join(map(pxr.Tf.MakeValidIdentifier, name.split(":")))
        primvar = self._api.GetPrimvar(name)
        if name not in self._made:
            primvar = self._api.CreatePrimvar(name, type_name, interpolation)
            self._keep(name, primvar.GetAttr(), interpolation, type_name)
        elif self._made[name][1:] != (interpolation, type_name):
            warn(f"frame {self._time}: the primvar {name} is left out: its type or domain is not that of the frames "
                 "before")
            return
        self._set.add(name)
        primvar.Set(values, self._time)
        if indices is not None:
            primvar.SetIndices(pxr.Vt.IntArray.FromNumpy(indices), self._time)

    def _keep(self, name: str, attribute: Any, interpolation: str, type_name: Any) -> None:
        self._made[name] = attribute, interpolation, type_name
        if self._is_sampled and self._first != self._time:
            attribute.Set(self._pxr.Sdf.ValueBlock(), self._first)

    def _of_all(self, name: str, domain: str, values: Array) -> tuple[str, Array]:
        """The interpolation; one value where the source has one and all are the same, which samples may cease to be."""
        is_constant = name in self._origin.constants and not self._is_sampled
        if is_constant and len(values) > 0 and bool((values == values[:1]).all()):
            return "constant", values[:1]
        return INTERPOLATIONS[domain], values

    def _add_color(self, domain: str, values: Array) -> None:
        import numpy as np

        pxr = self._pxr
        colors = values.astype(np.float32)
        if values.dtype.kind in "iu":
            colors = colors / np.float32(np.iinfo(values.dtype).max)
        interpolation, colors = self._of_all("color", domain, colors)
        names = pxr.Sdf.ValueTypeNames
        self._put("displayColor", names.Color3fArray, interpolation,
                  pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(colors[:, :3])))
        if colors.shape[1] == 4:
            self._put("displayOpacity", names.FloatArray, interpolation,
                      pxr.Vt.FloatArray.FromNumpy(np.ascontiguousarray(colors[:, 3])))

    def _uv_set_of(self, name: str) -> str:
        number, sets = int(name.removeprefix("uv") or 0), self._origin.uv_sets
        return sets[number] if number < len(sets) else f"st{number or ''}"

    def _add_uv(self, values: Array, name: str) -> None:
        """One value for all corners that share it, so that the seams of a map are those of its indices."""
        import numpy as np

        rows = np.nan_to_num(values.reshape(-1, 2).astype(np.float32))
        kept, indices = np.unique(rows, axis=0, return_inverse=True)
        self._put(name, self._pxr.Sdf.ValueTypeNames.TexCoord2fArray, "faceVarying",
                  self._pxr.Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(kept)), indices.reshape(-1).astype(np.int32))

    def _add_normals(self, result: Result, values: Array) -> None:
        """Where the source has none, those of the faces."""
        import numpy as np

        normals = values.astype(np.float32)
        missing = np.asarray(~np.isfinite(normals).all(axis=2))
        if missing.any():
            a, b, c = (result.vertices[result.faces[:, i]] for i in range(3))
            across = np.cross(b - a, c - a)
            across /= np.maximum(np.linalg.norm(across, axis=1), np.finfo(float).tiny)[:, None]
            normals = np.where(missing[:, :, None], across[:, None, :], normals).astype(np.float32)
        attribute = self._mesh.CreateNormalsAttr()
        if "normals" not in self._made:
            self._keep("normals", attribute, "faceVarying", None)
            self._mesh.SetNormalsInterpolation(self._pxr.UsdGeom.Tokens.faceVarying)
        self._set.add("normals")
        attribute.Set(self._pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(normals.reshape(-1, 3))), self._time)

    def _add_velocities(self, columns: list[Array]) -> None:
        """Those of a grid are of a frame, and USD's of a second."""
        import numpy as np

        a_second = self._mesh.GetPrim().GetStage().GetTimeCodesPerSecond()
        attribute = self._mesh.CreateVelocitiesAttr()
        if "velocities" not in self._made:
            self._keep("velocities", attribute, "vertex", None)
        self._set.add("velocities")
        rows = np.ascontiguousarray(np.column_stack(columns) * a_second, np.float32)
        attribute.Set(self._pxr.Vt.Vec3fArray.FromNumpy(rows), self._time)

    def _add_texts(self, name: str, domain: str, values: Array, labels: list[str]) -> None:
        import numpy as np

        indices = np.where((values >= 0) & (values < len(labels)), values, len(labels)).astype(np.int32)
        texts = labels + [""] if np.any(indices == len(labels)) else labels
        self._put(name, self._pxr.Sdf.ValueTypeNames.StringArray, INTERPOLATIONS[domain],
                  self._pxr.Vt.StringArray(texts), indices)

    def _add_numbers(self, name: str, domain: str, values: Array) -> None:
        import numpy as np

        names, arrays = self._pxr.Sdf.ValueTypeNames, self._pxr.Vt
        kinds = {"f4": (names.FloatArray, arrays.FloatArray, np.float32),
                 "f8": (names.DoubleArray, arrays.DoubleArray, np.float64),
                 "u1": (names.UCharArray, arrays.UCharArray, np.uint8),
                 "u4": (names.UIntArray, arrays.UIntArray, np.uint32)}
        type_name, array, dtype = kinds.get(values.dtype.str[1:], (names.IntArray, arrays.IntArray, np.int32))
        interpolation, values = self._of_all(name, domain, values)
        self._put(name, type_name, interpolation, array.FromNumpy(np.ascontiguousarray(values, dtype)))

    def _add_vectors(self, name: str, domain: str, columns: list[Array]) -> None:
        """In the source's type, or that of the numbers; where a run kept some of these only, each by itself."""
        import numpy as np

        of_numbers = {"f4": "float3", "f8": "double3"}.get(columns[0].dtype.str[1:], "int3")
        kind = self._origin.vectors.get(name, of_numbers).removesuffix("[]")
        type_name = self._pxr.Sdf.ValueTypeNames.Find(kind + "[]")
        array = type_name.type.pythonClass
        row = np.array(array(1))
        if row.shape[1] != len(columns):
            for i, column in enumerate(columns):
                self._add_numbers(f"{name}_{i}", domain, column)
            return
        interpolation, values = self._of_all(name, domain, np.column_stack(columns))
        self._put(name, type_name, interpolation, array.FromNumpy(np.ascontiguousarray(values, row.dtype)))
