"""Where the places of an array stand in the world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Protocol, Tuple

from ._arrays import array_of, triple_of
from ._errors import Error

if TYPE_CHECKING:
    import numpy as np

Triple = Tuple[float, float, float]


class OnLattice(Protocol):
    """A Volume, or Labels."""

    spacing: Any
    origin: Any
    affine: Any


def origin_and_steps_of(given: OnLattice) -> Tuple[Triple, List[Triple]]:
    """Where the first place of its array stands, and the steps from there to the next one along each axis, in world units."""
    return _of_spacing(given.spacing, given.origin) if given.affine is None else _of_affine(given)


def _of_spacing(spacing: Any, origin: Any) -> Tuple[Triple, List[Triple]]:
    x, y, z = triple_of("spacing", spacing)
    if not min(x, y, z) > 0:
        raise Error(f"spacing must be above 0, and is {(x, y, z)}; a volume that is mirrored needs affine")
    return triple_of("origin", origin), [(x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z)]


def _of_affine(given: OnLattice) -> Tuple[Triple, List[Triple]]:
    import numpy as np

    if triple_of("spacing", given.spacing) != (1, 1, 1) or triple_of("origin", given.origin) != (0, 0, 0):
        raise Error("affine says spacing and origin already; leave them out")
    matrix = array_of("affine", given.affine).astype(np.float64)
    if matrix.shape != (4, 4):
        raise Error(f"affine must have the shape (4, 4), and has {matrix.shape}")
    if not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise Error(f"the last row of affine must be 0, 0, 0, 1, and is {', '.join(f'{v:g}' for v in matrix[3])}")
    first, second, third, origin = (_as_triple(matrix[:3, column]) for column in range(4))
    return origin, [first, second, third]


def _as_triple(numbers: np.ndarray[Any, Any]) -> Triple:
    x, y, z = numbers.tolist()
    return x, y, z
