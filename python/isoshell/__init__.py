"""Isotropic triangle meshes from any surface, through sparse volumes.

    import isoshell
    result = isoshell.remesh("scan.ply", vertices=20_000)
    result = isoshell.remesh((vertices, faces), vertices=20_000, features="auto")
    result.vertices, result.faces, result.report
    result.save("mesh.ply")
    isoshell.mesh_info("mesh.ply", ref="scan.ply", require="closed,manifold")
"""

import atexit as _atexit
from typing import TYPE_CHECKING as _TYPE_CHECKING

from . import _enough_threads as _enough_threads  # before what it looks ahead for
from . import _isoshell
from ._context import Context, Progress
from ._errors import Error, RunWarning
from ._fill import Filled
from ._isoshell import VERSION as __version__
from ._isoshell import ErrorCode
from ._labels import Labels
from ._level_set import LevelSet
from ._many import remesh_many
from ._mesh_info import mesh_info
from ._options import Options
from ._remesh import estimate, level_set, remesh
from ._report import report
from ._result import Result
from ._sequence import Frames, remesh_sequence
from ._inputs import Mesh, Points, Volume
from ._stages import Stages

if _TYPE_CHECKING:
    from . import usd as usd

__all__ = ["Context", "Error", "ErrorCode", "Filled", "Frames", "Labels", "LevelSet", "Mesh", "Options", "Points", "Progress", "Result", "RunWarning",
           "Stages", "Volume", "__version__", "estimate", "level_set", "mesh_info", "remesh", "remesh_many",
           "remesh_sequence", "report"]

for _name in ("Context", "Error", "Filled", "Frames", "Labels", "LevelSet", "Mesh", "Points", "Progress", "Result", "RunWarning", "Stages", "Volume",
              "estimate", "level_set", "mesh_info", "remesh", "remesh_many", "remesh_sequence", "report"):
    globals()[_name].__module__ = __name__


def __getattr__(name: str) -> object:
    """isoshell.usd, which is imported where it is used."""
    if name == "usd":
        import importlib

        return importlib.import_module(".usd", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


_atexit.register(_isoshell.end_jobs_left_alone)
