"""The page that shows what a run made of its input."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional

from .. import _isoshell
from .._context import Context
from .._errors import Error
from .._keywords import Keywords
from .._paths import path_text
from .._result import Result
from .._sources import SourceLike, opened, source_of

if TYPE_CHECKING:
    from .._result import Floats, Ints

REMEDY = "pip install 'isoshell[report]'"


def report(result: Result, path: str | os.PathLike[str], *, source: Optional[SourceLike] = None,
           overwrite: bool = False) -> None:
    """Write one HTML file that shows a result beside its input, and opens without a network. Needs k3d.

    Both are drawn with one camera, coloured by deviation, quality, valence, gaps and creases; beside them are places to
    look at, histograms and all that the run has measured: the most after remesh(..., stats=True). Of meshes above
    120,000 triangles fewer are drawn, and the page says how many; numbers are of all.

    Args:
        result: what remesh() returned.
        path: the file, below 8 MB.
        source: what remesh() was given; it is needed for arrays, which a result does not keep. A file is read again.
            Without any the page shows the result alone.
        overwrite: replace a file that is there.

    Raises:
        Error: of code USAGE without k3d (pip install 'isoshell[report]'); of code UNWRITABLE_OUTPUT when the file
            cannot be written, or is there and overwrite is not True; what reading a file raises.
    """
    require_k3d()
    _refuse_existing(Path(path_text(path)), overwrite)
    write(result, source_of(opened(source)) if source is not None else result._source, path, overwrite)


def require_k3d() -> Path:
    """The folder of its scripts. It is not imported: that takes longer than the page."""
    found = importlib.util.find_spec("k3d")
    for folder in (found.submodule_search_locations or []) if found else []:
        scripts = Path(folder) / "static"
        if (scripts / "standalone.js").is_file() and (scripts / "fflate.js").is_file():
            return scripts
    raise Error(f"a report needs k3d 3: {REMEDY}", stage="report")


def has_k3d() -> bool:
    try:
        require_k3d()
    except Error:
        return False
    return True


def write(result: Result, source: Optional[_isoshell.Source], path: str | os.PathLike[str], overwrite: bool) -> None:
    """The page of a result and what it was made from."""
    from ._page import page

    surface = None if source is None else _surface_of(source, result._reading)
    _isoshell.write_text(path_text(path), page(result, surface, require_k3d()), overwrite)


def write_of_command(made: _isoshell.RunResult, source: _isoshell.Source, path: str, overwrite: bool) -> str:
    """The same for the command, which has looked at the path already; why it could not, if so."""
    try:
        write(Result(made), source, path, overwrite)
    except Error as error:
        return str(error)
    return ""


def _surface_of(source: _isoshell.Source, reading: Keywords) -> tuple[Floats, Ints, Ints]:
    def silent(is_warning: bool, text: str) -> None:
        """The run has told it."""

    place: Any = Context()._place
    vertices, faces, regions = _isoshell.read_surface(place, source, reading, silent)
    return vertices, faces, regions


def _refuse_existing(path: Path, overwrite: bool) -> None:
    if path.exists() and not overwrite:
        raise Error(f"{path}: exists already; overwrite=True replaces it", _isoshell.ErrorCode.UNWRITABLE_OUTPUT,
                    "report")
