"""The command isoshell: its first word names what to do. Without such a name it meshes, as it did before it had them."""

from __future__ import annotations

import difflib
import os
import sys
import warnings
from typing import Callable, Optional

from . import _isoshell
from ._errors import RunWarning
from ._exchange import formats
from ._isoshell import ErrorCode
from ._sources import opened, source_of
from ._usd import ENDINGS

Run = Callable[[list[str]], int]

NO_COMMAND = frozenset(". / : # %".split())  # characters of names of files, of grids and prims in them, and of frames

# In the shape that scripts/command_docs.py reads.
HELP = """isoshell COMMAND [arguments]

Makes isotropic triangle meshes of any surface, and measures meshes.

Commands:
  remesh INPUT OUTPUT           mesh a surface, or a sequence of them: a mesh, points, a volume, labels,
                                a stage of USD; isoshell INPUT OUTPUT does the same
  info MESH                     count and measure a mesh as it is stored, as vdb_meshinfo does
  farm run ASSETS OUT           mesh many assets over the workers of a cluster, or of this machine; also
                                farm status OUT and farm report OUT

Options:
  -h, --help                    print this help and exit; isoshell COMMAND --help says more of one
  -V, --version                 print the version and exit

A file that is called as a command is ./remesh, ./info or ./farm.

Exit status: 0 done, 1 internal error, 2 wrong usage, 3 input cannot be read, 4 output cannot be
written, 5 nothing to mesh, 6 a requirement of --require is not met or the result intersects
itself, 7 over the memory limit or out of memory, 8 no such device, 130 interrupted.
"""


def run_one_of(words: list[str], remesh: Run) -> int:
    """Run what the first word names, or else remesh. Returns the exit status."""
    commands: dict[str, Run] = {"remesh": remesh, "info": _info, "farm": _farm}
    first = words[0] if words else ""
    if first in ("-h", "--help"):
        print(HELP, end="")
        return 0
    if first in ("-V", "--version"):
        print(f"isoshell {_isoshell.VERSION}")
        return 0
    if not words:
        return _refuse("COMMAND is missing: remesh, info or farm; see isoshell --help")
    if first not in commands:
        meant = difflib.get_close_matches(first, commands) if NO_COMMAND.isdisjoint(first) else []
        if meant and not os.path.exists(first):
            return _refuse(f"there is neither a command nor a file {first}; did you mean {meant[0]}?")
        return remesh(words)
    status = commands[first](words[1:])
    if status == int(ErrorCode.USAGE) and os.path.isfile(first):
        _tell(f"{first} is taken as the command; the file of that name is ./{first}")
    return status


def vdb_meshinfo() -> int:
    """The command of that name. Returns its exit status."""
    return _measure("vdb_meshinfo", [*map(os.fspath, sys.argv[1:])])


def files_of_packages(of_stages: str, endings: list[str]) -> str:
    """What the help says of files beside those of the command."""
    names = " ".join(f".{ending}" for ending in endings)
    return f"or a stage of USD ({' '.join(ENDINGS)}{of_stages}), or a file by other Python packages\n        ({names})"


def that_are_read() -> str:
    """The same of those that are read."""
    return files_of_packages("; FILE:/PRIM names a prim", [each.ending for each in formats() if each.reads])


def _info(words: list[str]) -> int:
    return _measure("isoshell info", words)


def _measure(program: str, words: list[str]) -> int:
    return _isoshell.mesh_info_command([program, *words], _opened_by_python, that_are_read())


def _opened_by_python(path: str) -> Optional[tuple[_isoshell.Source, list[str]]]:
    """A file that the library does not read as a source, with the warnings of it; None for one that nobody reads."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("ignore")
        warnings.simplefilter("always", RunWarning)
        given = opened(path)
        return None if given is path else (source_of(given), [str(warning.message) for warning in told])


def _farm(words: list[str]) -> int:
    from ._farm._command import main

    try:
        return main(words)
    except SystemExit as ended:  # of argparse, which has told what it is about
        return ended.code if isinstance(ended.code, int) else 0


def _refuse(text: str) -> int:
    _tell(f"error: {text}")
    return int(ErrorCode.USAGE)


def _tell(text: str) -> None:
    print(f"isoshell: {text}", file=sys.stderr)
