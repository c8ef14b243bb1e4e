"""Files that other packages read and write."""

from __future__ import annotations

import importlib
import os
import tempfile
from typing import TYPE_CHECKING, Any, Iterable

from .. import _isoshell
from .._errors import Error, warn, words_of
from .._inputs import Mesh, Points
from .._isoshell import ErrorCode
from .._paths import writing
from . import Format, format_of, formats

if TYPE_CHECKING:
    from .._result import Result


def read(path: str, options: dict[str, Any]) -> Any:
    """A file as a source; what of the options only this reading needs is taken out of them.

    Raises:
        Error: of code UNREADABLE_INPUT for a file that cannot be read, USAGE without its package.
    """
    format = _format_for(path, "reads")
    if not os.path.isfile(path):
        what = "is a folder, not a file" if os.path.isdir(path) else "no such file"
        raise Error(f"{path}: {what}", ErrorCode.UNREADABLE_INPUT, "read")
    module = _module_of(format)
    try:
        made = module.read(path, options)
    except Error as error:
        raise error if str(error).startswith(path) else Error(f"{path}: {error}", error.code, error.stage) from error
    except Exception as error:  # whatever the package raises of a damaged file
        raise Error(f"{path}: {format.extra}: {words_of(error)}", ErrorCode.UNREADABLE_INPUT, "read") from error
    if isinstance(made, Points) and len(made.positions) == 0:
        raise Error(f"{path}: {format.extra} finds neither faces nor points in it", ErrorCode.NOTHING_TO_MESH, "read")
    if isinstance(made, Mesh):
        made.name = path
    return made


def check_target(path: str, overwrite: bool, others: Iterable[tuple[str, str]] = (),
                 inputs: Iterable[tuple[str, str]] = (), replaces: str = "") -> None:
    """Before a run: whether its result could be written there, beside its other files and those that it reads, of which
    it may be the one that it replaces.

    Raises:
        Error: of code UNWRITABLE_OUTPUT or USAGE.
    """
    module = _module_of(_format_for(path, "writes"))
    module.check(path)
    beside = [("the numbers of OUTPUT", file) for file in module.files_beside(path)]
    _isoshell.check_output_files([("OUTPUT", path), *beside, *others], list(inputs), overwrite, replaces)


def write(path: str, made: Result | Mesh, overwrite: bool) -> None:
    """Under another name first, so that nothing half-written is left. What the format does not hold is warned of."""
    check_target(path, overwrite)
    format = _format_for(path, "writes")
    with writing(path), tempfile.TemporaryDirectory(prefix=".isoshell-", dir=os.path.dirname(path) or ".") as work:
        part = os.path.join(work, os.path.basename(path))
        lost = _module_of(format).write(made, part)
        for file in sorted(os.listdir(work)):  # XDMF has its numbers in a file beside it
            _isoshell.put_in_place(os.path.join(work, file), os.path.join(os.path.dirname(path), file), overwrite)
    if lost:
        warn(f"{path}: .{format.ending} files hold no {', '.join(lost)}; those of .ply, .glb and .vtp do")


def _format_for(path: str, what: str) -> Format:
    format = format_of(path)
    if format is None or not getattr(format, what):
        endings = ", ".join("." + format.ending for format in formats() if getattr(format, what))
        raise Error(f"{path}: no package {what} that; the ending must be one of {endings}")
    return format


def _module_of(format: Format) -> Any:
    return importlib.import_module(f"._{format.extra}", __package__)
