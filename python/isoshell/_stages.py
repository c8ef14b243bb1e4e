"""The stages of a run one by one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional

from . import _isoshell
from ._context import Context
from ._errors import Error
from ._paths import path_text
from ._remesh import begun, listener
from ._result import Result
from ._sources import SourceLike

if TYPE_CHECKING:
    import numpy as np
    from typing_extensions import Unpack

    from ._options import Options

OF_WHOLE_RUNS = ("save_shell", "save_voronoi", "save_level_set", "level_set_band", "level_set_of", "level_set_half", "split_regions", "stop_after", "stats", "report", "force",
                 "require", "allow_intersections", "output_format", "color_features")


class Stages:
    """The stages of a run, to stop between them and look at their products.

    Each runs those before it that have not run yet, and what it made is kept. All of them together make the mesh of
    remesh().

    Args:
        source, context, options: as remesh() takes them, but for what concerns files and requirements.

    Raises:
        Error: as remesh() does. After a stage failed, or anything was interrupted, the stages refuse to go on.
    """

    def __init__(self, source: SourceLike, *faces: Any, context: Optional[Context] = None, **options: Unpack[Options]) -> None:
        given: dict[str, Any] = dict(options)
        refused = [name for name in OF_WHOLE_RUNS if given.get(name)]
        if refused:
            raise Error(f"{', '.join(refused)}: only remesh() takes that", stage="options")
        place, progress, start, keywords = begun(source, faces, context, given)
        self._run = _isoshell.StageRun(place, start, keywords, progress, listener(given))
        self._result: Optional[Result] = None

    def prepare(self) -> Stages:
        """Repair the surface, choose the grid, voxelise: surface, sites, shell and sheet."""
        self._run.prepare()
        return self

    def relax(self) -> Stages:
        """Place the seeds and relax them: a centroidal Voronoi tessellation of the sheet."""
        self._run.relax()
        return self

    def triangulate(self) -> Result:
        """Make the mesh: the dual of the tessellation, repaired and improved."""
        if self._result is None:
            self._result = Result(self._run.triangulate())
        return self._result

    @property
    def digests(self) -> dict[str, str]:
        """Of each product that was made, by name, sixteen hexadecimal digits: the same on every machine."""
        return dict(self._run.digests())

    @property
    def frame(self) -> dict[str, Any]:
        """Where the lattice lies: origin and voxel_size (world units), resolution and extent (voxels)."""
        return self._run.frame()

    @property
    def sheet(self) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
        """The closed surface that seeds move on: vertices (N, 3) float64, world units, and faces (F, 3) int32."""
        return self._run.sheet()

    @property
    def seeds(self) -> np.ndarray[Any, Any]:
        """(K, 3) float64, world units: where the relaxed seeds are."""
        return self._run.seeds()  # type: ignore[no-any-return]

    def save_shell(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write the stage file of the shell, from which remesh() and the command resume."""
        self._run.save_shell(path_text(path), overwrite)

    def save_voronoi(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write the stage file of the Voronoi volume, and its preview. Surfaces with creases or borders that are kept have none."""
        self._run.save_voronoi(path_text(path), overwrite)
