"""Images of nibabel: whole numbers are labels, and others a volume."""

from __future__ import annotations

from typing import Any

from .._errors import Error
from .._keywords import whole_number_of
from .._labels import Labels
from .._inputs import Volume
from . import package


def taken(given: Any, options: dict[str, Any]) -> Any:
    """Labels with the image's affine; with an isovalue, and where values are not whole, a Volume with it. Of the options,
    background, smallest_island, smoothing and periodic, which are of labels, are taken out.

    Raises:
        Error: of code USAGE for what is no image of three dimensions, and for options that are not what Labels takes.
    """
    import numpy as np

    package("nibabel", "an object of nibabel")
    shape, affine = getattr(given, "shape", None), getattr(given, "affine", None)
    if shape is None or affine is None:
        raise Error(f"source is a {type(given).__name__} of nibabel; give an image with an affine, such as a Nifti1Image")
    values = np.asanyarray(given.dataobj)
    values = values.reshape(values.shape[:3]) if values.shape[3:] == (1,) * (values.ndim - 3) else values
    if values.ndim != 3:
        raise Error(f"source is an image of the shape {tuple(shape)}; give one volume of it, such as image.slicer[..., 0]")
    if options.get("iso") is None and (values.dtype.kind in "biu" or np.array_equal(values, np.rint(values))):
        labels = Labels(values if values.dtype.kind in "biu" else values.astype(np.int64), affine=np.array(affine, float))
        for name in ("background", "smallest_island"):
            if options.get(name) is not None:
                setattr(labels, name, whole_number_of(name, options.pop(name)))
        for name in ("smoothing", "periodic"):
            if options.get(name) is not None:
                setattr(labels, name, options.pop(name))
        return labels
    return Volume(values, affine=np.array(affine, float))


def read(path: str, options: dict[str, Any]) -> Any:
    """What a file has."""
    return taken(package("nibabel", f"{path}: this format").load(path), options)
