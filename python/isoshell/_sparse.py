"""Volumes that are no dense array: voxels with values, level sets, grids of OpenVDB, and bytes of .vdb and .nvdb files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from ._arrays import array_of, axes_of, floats_or_nan, triple_of
from ._errors import Error
from ._inputs import Volume, is_vdb_grid
from ._isoshell import Source
from ._lattice import origin_and_steps_of
from ._level_set import LevelSet

if TYPE_CHECKING:
    import numpy as np

BYTES = (bytes, bytearray, memoryview)
INT32 = (-(2**31), 2**31 - 1)


def is_sparse(given: Any) -> bool:
    """Whether it is a Volume whose values are no dense array."""
    return isinstance(given, Volume) and (given.coordinates is not None or places_itself(given.values))


def places_itself(values: Any) -> bool:
    """Whether they know where they stand: a grid, a level set, a file."""
    return isinstance(values, (LevelSet, *BYTES)) or is_vdb_grid(values)


def sparse_source_of(volume: Volume) -> Source:
    """The source of such a volume."""
    asked = {"velocities": volume.velocities is not None, "sides": volume.sides is not None,
             "periodic": any(axes_of("periodic", volume.periodic))}
    for name, is_asked in asked.items():
        if is_asked:
            raise Error(f"{name} is of volumes that are arrays; leave it out for a sparse one")
    values = volume.values
    if not places_itself(values):
        return Source.sparse(coordinates_of(volume.coordinates), floats_or_nan("values", values),
                             background_of(volume.background), False, *origin_and_steps_of(volume))
    refuse_place(volume)
    if isinstance(values, LevelSet):
        placed = Volume(values.values, affine=values.transform)
        return Source.sparse(values.coordinates, values.values, values.background, True, *origin_and_steps_of(placed))
    return Source.vdb("volume", bytes_of(values))


def refuse_place(volume: Volume) -> None:
    is_placed = (triple_of("spacing", volume.spacing) != (1, 1, 1) or triple_of("origin", volume.origin) != (0, 0, 0)
                 or volume.affine is not None)
    if is_placed or volume.coordinates is not None or volume.background is not None:
        raise Error(f"the values are {type(volume.values).__name__}, which says where its voxels are and what is around "
                    "them; leave out spacing, origin, affine, coordinates and background")


def coordinates_of(given: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    voxels = array_of("coordinates", given)
    if voxels.ndim != 2 or voxels.shape[1] != 3 or voxels.dtype.kind not in "iu":
        raise Error(f"coordinates must be whole numbers of the shape (K, 3), and are {voxels.dtype} of the shape "
                    f"{voxels.shape}")
    if voxels.dtype != np.int32 and voxels.size and not INT32[0] <= int(voxels.min()) <= int(voxels.max()) <= INT32[1]:
        raise Error("coordinates must be whole numbers that 32 bits hold, and one is "
                    f"{int(voxels.max()) if int(voxels.max()) > INT32[1] else int(voxels.min())}")
    return np.ascontiguousarray(voxels, np.int32)


def background_of(given: Any) -> float:
    """NaN where it is to be chosen."""
    if given is None:
        return float("nan")
    number = array_of("background", given)
    if number.shape != () or not abs(float(number)) < float("inf"):
        raise Error(f"background is {given!r}; it must be a finite number")
    return float(number)


def bytes_of(values: Any) -> np.ndarray[Any, Any]:
    import numpy as np

    held = bytes(values) if isinstance(values, memoryview) and not values.contiguous else values
    held = held if isinstance(held, BYTES) else _pickled_grid(held)
    return np.frombuffer(held, np.uint8)


def _pickled_grid(grid: Any) -> bytes:
    """A grid of OpenVDB's module as it is pickled: the bytes of a stream, which any version of the library reads."""
    state = grid.__reduce_ex__(2)[2]
    found: Optional[bytes] = next((part for part in _parts_of(state) if isinstance(part, bytes)), None)
    if found is None:
        raise Error(f"this {type(grid).__name__} cannot be pickled, which is how it is read; write it to a .vdb file")
    return found


def _parts_of(state: Any) -> Any:
    if isinstance(state, (tuple, list)):
        for part in state:
            yield from _parts_of(part)
    else:
        yield state
