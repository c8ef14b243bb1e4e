"""Volumes of labels, whose regions a run meshes together."""

from __future__ import annotations

import numbers
import operator
import os
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence

from . import _isoshell
from ._arrays import axes_of, masked_array_of
from ._errors import Error, warn
from ._inputs import lattice_text
from ._lattice import origin_and_steps_of
from ._paths import path_text

if TYPE_CHECKING:
    import numpy as np

LEAST_SMOOTHING = 0.05  # voxels that part walls which touch one another in edges
INT32 = (-(2**31), 2**31 - 1)


class Labels:
    """Labels of voxels: a segmentation, the grains of a polycrystal, the phases of a material.

    A region is all voxels of one label; what is outside of the array is background. The result has the walls between
    regions once, and the closed boundary of each: see Result.regions and Result.region.

    Args:
        array: (X, Y, Z) whole numbers, background where they are masked, of any type and strides that fit int32; voxel (i, j, k) is centred at
            origin + (i, j, k) * spacing. Where the array begins with z, give array.transpose(2, 1, 0).
        spacing: world units from a voxel to the next, one number or one an axis.
        origin: the centre of voxel (0, 0, 0), world units.
        affine: (4, 4), from (i, j, k, 1) to world units, as nibabel has it; instead of spacing and origin. It may turn,
            skew and mirror.
        names: what regions are called, by label.
        background: the label of what is no region.
        smallest_island: islands of fewer voxels, connected through faces, get the label around them, which is warned of;
            the largest one of each region stays. 0: all stay.
        smoothing: how far, in voxels, walls may leave the faces of their voxels along each axis to be smooth, 0.05 to 1,
            and a quarter farther where regions meet in curves; at 0 they are these faces, flat, and where they turn are
            creases.
        periodic: axes of the array, as "x,y,z", along which it goes on with its first layer: the result has the walls of
            one period, from the centres of that layer to those of its repetition, and opposite sides have the same
            triangles, translated.
    """

    def __init__(self, array: Any, spacing: Any = (1, 1, 1), origin: Any = (0, 0, 0), affine: Any = None,
                 names: Optional[Mapping[int, str]] = None, background: int = 0, smallest_island: int = 8,
                 smoothing: float = 0.5, periodic: str = "") -> None:
        self.array = array
        self.spacing = spacing
        self.origin = origin
        self.affine = affine
        self.names = dict(names or {})
        self.background = background
        self.smallest_island = smallest_island
        self.smoothing = smoothing
        self.periodic = periodic

    def __repr__(self) -> str:
        names = f", {len(self.names)} names" if self.names else ""
        return f"<isoshell.Labels: {lattice_text(self.array)}{names}>"

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write an Int32Grid to a .vdb file, which the command and remesh() read as these labels.

        Raises:
            Error: of code UNWRITABLE_OUTPUT when it cannot be written, or is there and overwrite is not True; of code
                USAGE for what remesh() refuses.
        """
        _isoshell.write_labels(path_text(path), values_of(self), lattice_of(self), overwrite)


def values_of(labels: Labels) -> np.ndarray[Any, Any]:
    """The array as whole numbers."""
    import numpy as np

    values, mask = masked_array_of("labels", labels.array)
    if values.dtype.kind == "f":
        raise Error(f"labels must be whole numbers, and are {values.dtype}; round them: "
                    "numpy.rint(array).astype(numpy.int32)")
    values = values.astype(np.uint8) if values.dtype.kind == "b" else values
    return values if mask is None else np.where(mask, labels.background, values)


def lattice_of(labels: Labels) -> _isoshell.LabelLattice:
    """Where the voxels are, and what their regions are called."""
    origin, steps = origin_and_steps_of(labels)
    names = {label_of("a key of names", label): _name(label, name) for label, name in labels.names.items()}
    return _isoshell.LabelLattice(origin, steps, label_of("background", labels.background), names,
                                  label_of("smallest_island", labels.smallest_island),
                                  _smoothing(labels.smoothing), axes_of("periodic", labels.periodic))


def _smoothing(value: Any) -> float:
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or not (value == 0 or LEAST_SMOOTHING <= value <= 1):
        raise Error(f"smoothing is {value!r}; it must be a number from {LEAST_SMOOTHING} to 1, or 0 for the faces of voxels")
    return float(value)


def joined_regions(source: str, parts: Sequence[Optional[Mapping[str, Any]]]) -> Optional[dict[str, Any]]:
    """Those of several meshes, as Mesh.regions has them. Regions of one name are one region; any other is one of its
    own, under its label or, where that is taken, the next free one. None, with a warning, where some have none."""
    import numpy as np

    known = [part for part in parts if part is not None]
    if known and len(known) < len(parts):
        warn(f"{source}: the regions of {len(known)} of {len(parts)} meshes are left out, since the others have none; "
             "mesh these and those by themselves")
    if len(known) == 0 or len(known) < len(parts):
        return None
    background = known[0]["background"]
    names: dict[int, str] = {}
    used, labels = {background}, []
    for part in known:
        number_of = {part["background"]: background}
        named = {name: number for number, name in names.items()}  # in the meshes before
        values, at = np.unique(part["labels"], return_inverse=True)
        for label in values.tolist():
            if label not in number_of:
                free = max(used) + 1 if label in used else label
                number_of[label] = named.get(part["names"].get(label), free)
                used.add(number_of[label])
        names.update({number_of[label]: name for label, name in part["names"].items() if label in number_of})
        labels.append(np.array([number_of[label] for label in values.tolist()], np.int32)[at].reshape(-1, 2))
    return {"labels": np.concatenate(labels), "background": background, "names": names}


def label_of(argument: str, value: Any) -> int:
    """A label as int, which 32 bits hold."""
    try:
        label = operator.index(value)
    except TypeError:
        raise Error(f"{argument} is {value!r}; labels are whole numbers") from None
    if not INT32[0] <= label <= INT32[1]:
        raise Error(f"{argument} is {label}; labels are whole numbers from {INT32[0]} to {INT32[1]}")
    return label


def _name(label: Any, name: Any) -> str:
    if not isinstance(name, str):
        raise Error(f"names[{label!r}] is {name!r}; it must be text")
    if not name.strip() or not name.isprintable():
        raise Error(f"names[{label!r}] is {name!r}; a name is one line of text that can be printed")
    return name
