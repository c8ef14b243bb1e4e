"""Regions of a result as subsets of a mesh's faces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._result import Result

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

FAMILY = "regions"


def write_regions(pxr: Any, mesh: Any, result: Result) -> None:
    """Defines a subset of faces for each pair of regions that faces part: a partition, by the name of both."""
    import numpy as np

    regions = result.regions
    labels: Array = regions["labels"]
    if len(labels) == 0:
        return
    pairs, of_face = np.unique(labels, axis=0, return_inverse=True)
    for number, (inside, outside) in enumerate(pairs.tolist()):
        words = [regions["names"].get(label, str(label)) for label in (inside, outside)]
        name = pxr.Tf.MakeValidIdentifier("region_" + "_".join(words))
        faces = np.flatnonzero(of_face.reshape(-1) == number).astype(np.int32)
        subset = pxr.UsdGeom.Subset.CreateUniqueGeomSubset(
            mesh, name, pxr.UsdGeom.Tokens.face, pxr.Vt.IntArray.FromNumpy(faces), FAMILY)
        subset.GetPrim().SetCustomDataByKey("isoshell:regions", pxr.Vt.IntArray([inside, outside]))
    pxr.UsdGeom.Subset.SetFamilyType(mesh, FAMILY, pxr.UsdGeom.Tokens.partition)
