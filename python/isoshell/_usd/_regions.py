"""Regions of a result as subsets of a mesh's faces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Optional, Tuple

from .._errors import Error
from .._labels import label_of
from .._result import Result
from . import unreadable
from ._faces import values_of

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

FAMILY = "regions"
PAIR, NAMES = "isoshell:regions", "isoshell:region_names"  # keys of custom data: of a subset, and of the mesh
Pair = Tuple[int, int]  # the region behind faces, and the one in front of them


def write_regions(pxr: Any, mesh: Any, result: Result) -> None:
    """Defines a subset of faces for each pair of regions that faces part: a partition, by the name of both."""
    faces_of = _faces_of_pairs(result)
    for pair, faces in faces_of.items():
        _define(pxr, mesh, result, pair).GetIndicesAttr().Set(pxr.Vt.IntArray.FromNumpy(faces))
    if faces_of:
        _write_names(mesh, result)
        pxr.UsdGeom.Subset.SetFamilyType(mesh, FAMILY, pxr.UsdGeom.Tokens.partition)


class SampledRegions:
    """The same, sample by sample: a pair that a frame has not is empty there. The subsets are a partition as long as
    every frame has regions."""

    def __init__(self, pxr: Any, mesh: Any) -> None:
        self._pxr = pxr
        self._mesh = mesh
        self._subsets: Dict[Pair, Any] = {}
        self._first: Any = None
        self._is_partition = True

    def add(self, result: Result, time: Any) -> None:
        """The regions of a result."""
        import numpy as np

        faces_of = _faces_of_pairs(result)
        self._first = self._first or time
        self._is_partition = self._is_partition and bool(faces_of)
        for pair in sorted(set(faces_of) - set(self._subsets)):
            self._subsets[pair] = self._defined(result, pair)
        for pair, subset in self._subsets.items():
            faces = faces_of.get(pair, np.zeros(0, np.int32))
            subset.GetIndicesAttr().Set(self._pxr.Vt.IntArray.FromNumpy(faces), time)
        if self._subsets:
            _write_names(self._mesh, result)
            tokens = self._pxr.UsdGeom.Tokens
            kind = tokens.partition if self._is_partition else tokens.nonOverlapping
            self._pxr.UsdGeom.Subset.SetFamilyType(self._mesh, FAMILY, kind)

    def _defined(self, result: Result, pair: Pair) -> Any:
        """Empty from the first frame on: before its first sample an attribute has the value of that sample."""
        subset = _define(self._pxr, self._mesh, result, pair)
        subset.GetIndicesAttr().ClearDefault()
        subset.GetIndicesAttr().Set(self._pxr.Vt.IntArray(), self._first)
        return subset


def _faces_of_pairs(result: Result) -> Dict[Pair, Array]:
    """The faces between each two regions, ascending; empty without regions."""
    import numpy as np

    labels: Array = result.regions["labels"]
    pairs, of_face = np.unique(labels, axis=0, return_inverse=True)
    return {(inside, outside): np.flatnonzero(of_face.reshape(-1) == number).astype(np.int32)
            for number, (inside, outside) in enumerate(pairs.tolist())}


def _write_names(mesh: Any, result: Result) -> None:
    names = {str(label): name for label, name in result.region_names.items()}
    mesh.GetPrim().SetCustomDataByKey(NAMES, {"background": int(result.regions["background"]), "names": names})


def _define(pxr: Any, mesh: Any, result: Result, pair: Pair) -> Any:
    """A subset without faces yet, by the names of both regions."""
    words = [result.region_names.get(label, str(label)) for label in pair]
    name = pxr.Tf.MakeValidIdentifier("region_" + "_".join(words))
    subset = pxr.UsdGeom.Subset.CreateUniqueGeomSubset(
        mesh, name, pxr.UsdGeom.Tokens.face, pxr.Vt.IntArray(), FAMILY)
    subset.GetPrim().SetCustomDataByKey(PAIR, pxr.Vt.IntArray(pair))
    return subset


def read_regions(pxr: Any, mesh: Any, time: Any, face_count: int) -> Optional[Array]:
    """Of each face of a prim the two regions that it parts, (N, 2), where subsets that were written here say it of all."""
    import numpy as np

    labels = np.zeros((face_count, 2), np.int32)
    is_said = np.zeros(face_count, bool)
    for subset in pxr.UsdGeom.Subset.GetGeomSubsets(pxr.UsdGeom.Imageable(mesh), pxr.UsdGeom.Tokens.face, FAMILY):
        pair = subset.GetPrim().GetCustomDataByKey(PAIR)
        if pair is None:
            continue
        if not isinstance(pair, pxr.Vt.IntArray) or len(pair) != 2:
            raise _refused(subset, PAIR, pair, "two labels")
        faces = values_of(subset.GetIndicesAttr(), time)
        if np.any((faces < 0) | (faces >= face_count)):
            continue
        labels[faces], is_said[faces] = list(pair), True
    return labels if face_count and is_said.all() else None


def read_names(pxr: Any, mesh: Any) -> Tuple[int, Dict[int, str]]:
    """The background's label, and what regions are called."""
    data = mesh.GetPrim().GetCustomDataByKey(NAMES) or {}
    try:
        names = {label_of(NAMES, int(label)): str(name) for label, name in data.get("names", {}).items()}
        return label_of(NAMES, data.get("background", 0)), names
    except (AttributeError, ValueError, Error):
        raise _refused(mesh, NAMES, data, "a background and names by label") from None


def _refused(prim: Any, key: str, data: Any, meant: str) -> Error:
    return unreadable(str(prim.GetPath()), f"its custom data {key} is {data!r}, and not {meant}")
