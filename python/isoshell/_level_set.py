"""Signed distances near a surface, as sparse arrays."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _isoshell
from ._context import memory_bytes_of
from ._paths import path_text

if TYPE_CHECKING:
    import numpy as np


class LevelSet:
    """Signed distances around the solid that a surface bounds, negative inside, in the voxels near it.

    isoshell.level_set() makes one, and Result.level_set is one. isoshell.Volume takes it as its values. It can be copied
    and pickled.

    Attributes:
        voxel_size: world units.
        background: the distance that all other voxels outside have, and those inside its negative; world units.
        band: how far it reaches on both sides, in voxels.
    """

    def __init__(self, made: _isoshell.MadeLevelSet) -> None:
        self._made = made
        self._coordinates: Optional[np.ndarray[Any, Any]] = None
        self._values: Optional[np.ndarray[Any, Any]] = None
        self.voxel_size = made.voxel_size
        self.background = made.background
        self.band = made.band

    @property
    def coordinates(self) -> np.ndarray[Any, Any]:
        """(K, 3) int32: the voxels that have a distance of their own. The array is made once."""
        if self._coordinates is None:
            self._coordinates = self._made.coordinates()
        return self._coordinates

    @property
    def values(self) -> np.ndarray[Any, Any]:
        """(K,) float32: of each of them the distance from its centre, world units, as save() writes it. Made once."""
        if self._values is None:
            self._values = self._made.values()
        return self._values

    @property
    def transform(self) -> np.ndarray[Any, Any]:
        """(4, 4) float64: from coordinates (i, j, k, 1) to the world, where the centre of that voxel is."""
        import numpy as np

        matrix = np.diag([self.voxel_size] * 3 + [1.0])
        matrix[:3, 3] = self._made.origin
        return matrix

    def to_array(self, max_memory: Optional[Union[int, str]] = None) -> np.ndarray[Any, Any]:
        """All distances of the box around the coordinates, with a sign everywhere: float32, and element [i, j, k] is
        voxel coordinates.min(axis=0) + (i, j, k). Cost: the memory of the box.

        Args:
            max_memory: refuse an array that would take more, as "512M", "8G" or bytes; without it 80 % of what is free.

        Raises:
            Error: of code OUT_OF_MEMORY for a larger one.
        """
        array: np.ndarray[Any, Any] = self._made.dense(memory_bytes_of(max_memory))
        return array

    def save(self, path: Union[str, os.PathLike[str]], *, grid: str = "surface", half: bool = False,
             overwrite: bool = False) -> None:
        """Write a .vdb file that OpenVDB's programs open, the same as remesh(..., save_level_set=path) does.

        Args:
            path: file.
            grid: name of the grid.
            half: values in 16 bits.
            overwrite: replace a file that is there.

        Raises:
            Error: of code UNWRITABLE_OUTPUT when it cannot be written, or is there and overwrite is not True.
        """
        self._made.save(path_text(path), grid, half is True, overwrite is True)

    def __getstate__(self) -> dict[str, Any]:
        """Without the arrays, which are made again."""
        return {**self.__dict__, "_coordinates": None, "_values": None}

    def __len__(self) -> int:
        return self._made.voxels

    def __repr__(self) -> str:
        return f"<isoshell.LevelSet: {len(self)} voxels of {self.voxel_size:g}, {self.band:g} on each side>"
