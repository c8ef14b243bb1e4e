"""Grids in memory whose values the vertices of a result get."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Mapping

from ._arrays import floats_or_nan, masked_array_of, shape_of
from ._errors import Error
from ._inputs import Volume
from ._isoshell import GivenGrid, Source
from ._lattice import origin_and_steps_of
from ._level_set import LevelSet
from ._paths import encodable
from ._sparse import background_of, bytes_of, coordinates_of, is_sparse, places_itself, refuse_place

if TYPE_CHECKING:
    import numpy as np

MOST_WHOLE = 2**24  # whole numbers that single precision holds
WHAT = "an isoshell.Volume, an array on the lattice of the source, a grid of OpenVDB, an isoshell.LevelSet or the bytes of a .vdb file, not of a .nvdb file"


def grids_of(options: dict[str, Any]) -> Mapping[str, Any]:
    """Takes grids in memory out of the options; names of grids of files stay there."""
    given: Mapping[str, Any] = options.pop("grids") if isinstance(options.get("grids"), Mapping) else {}
    for name in given:
        if not isinstance(name, str) or not name:
            raise Error(f"a name of grids is {name!r}; it must be text, which the result's attribute is called by")
    return given


def add_grids(start: Source, grids: Mapping[str, Any], source: Any, max_bytes: int) -> None:
    """Gives the grids to the source of a run; arrays alone stand where the values of `source` stand. None takes more than
    the limit in bytes, or with 0 than what is free."""
    for name, given in grids.items():
        start.add_grid(_grid_of(encodable(name), _placed(name, given, source), max_bytes))


def _placed(name: str, given: Any, source: Any) -> Volume:
    if isinstance(given, Volume):
        return given
    if places_itself(given):
        return Volume(given)
    if isinstance(given, str) or not hasattr(given, "__len__"):
        raise Error(f"grids[{name!r}] is {given!r}; it must be {WHAT}")
    if isinstance(source, Volume) and not is_sparse(source) and shape_of(given)[:3] == shape_of(source.values):
        return Volume(given, spacing=source.spacing, origin=source.origin, affine=source.affine)
    raise Error(f"grids[{name!r}] is an array of the shape {shape_of(given)}, and the source no array of as many values: say "
                "where it stands, as isoshell.Volume(array, spacing=, origin=) or affine=")


def _grid_of(name: str, volume: Volume, max_bytes: int) -> GivenGrid:
    values = volume.values
    if isinstance(values, LevelSet):
        refuse_place(volume)
        placed = Volume(values.values, affine=values.transform)
        return GivenGrid.sparse(name, values.coordinates, values.values, values.background, True,
                                *origin_and_steps_of(placed), max_bytes)
    if places_itself(values):
        refuse_place(volume)
        return GivenGrid.vdb(name, bytes_of(values))
    array, mask = masked_array_of(f"grids[{name!r}]", volume.values)
    is_whole = array.dtype.kind in "iub"
    sparse = volume.coordinates is not None
    floats = floats_or_nan(f"grids[{name!r}]", volume.values)
    if floats.ndim not in ((1, 2) if sparse else (3, 4)) or floats.shape[1 if sparse else 3:] not in ((), (3,)):
        shapes = "(K,) or (K, 3) beside coordinates" if sparse else "(X, Y, Z) or (X, Y, Z, 3)"
        raise Error(f"grids[{name!r}] has the shape {floats.shape}; it must be {shapes}")
    if is_whole and (sparse or floats.ndim == 4 or not _are_held(array if mask is None else array[~mask])):
        raise Error(f"grids[{name!r}] has whole numbers, which are not interpolated: give them as an array (X, Y, Z), none "
                    f"beyond {MOST_WHOLE}; or give floats")
    return _joined(name, [_number_grid(name, part, volume, is_whole, max_bytes) for part in _parts(floats)])


def _are_held(whole: np.ndarray[Any, Any]) -> bool:
    """Whether single precision holds all these whole numbers."""
    return whole.size == 0 or -MOST_WHOLE <= int(whole.min()) <= int(whole.max()) <= MOST_WHOLE


def _parts(floats: np.ndarray[Any, Any]) -> List[np.ndarray[Any, Any]]:
    """Of numbers themselves, of vectors their components."""
    import numpy as np

    if floats.ndim in (1, 3):
        return [floats]
    return [np.ascontiguousarray(floats[..., axis]) for axis in range(3)]


def _number_grid(name: str, values: np.ndarray[Any, Any], volume: Volume, is_whole: bool, max_bytes: int) -> GivenGrid:
    import numpy as np

    if volume.coordinates is None:
        return GivenGrid.dense(name, values, is_whole, *origin_and_steps_of(volume), max_bytes)
    background = 0.0 if volume.background is None else background_of(volume.background)
    return GivenGrid.sparse(name, coordinates_of(volume.coordinates), np.ascontiguousarray(values), background, False,
                            *origin_and_steps_of(volume), max_bytes)


def _joined(name: str, parts: List[GivenGrid]) -> GivenGrid:
    return parts[0] if len(parts) == 1 else GivenGrid.vector(name, *parts)
