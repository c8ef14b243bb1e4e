"""Meshes and volumes of other packages, and files that these packages read and write. Each is imported where it is used."""

from __future__ import annotations

import importlib
import os
from typing import Any, NamedTuple, Optional

from .. import _isoshell
from .._errors import Error, words_of
from .._isoshell import ErrorCode

PACKAGES = {  # of a module: what to install
    "gmsh": "fill",
    "h5py": "meshio",
    "meshio": "meshio",
    "nibabel": "nibabel",
    "networkx": "trimesh",
    "lxml": "trimesh",
    "pymeshlab": "pymeshlab",
    "pyvista": "pyvista",
    "tetgen": "fill",
    "trimesh": "trimesh",
}
TAKERS = {  # of what a class comes from: the module here that takes its objects
    "trimesh": "_trimesh",
    "pyvista": "_pyvista",
    "vtkmodules": "_pyvista",
    "meshio": "_meshio",
    "pymeshlab": "_pymeshlab",
    "nibabel": "_nibabel",
}


class Format(NamedTuple):
    """A format of files by one of these packages."""

    ending: str
    extra: str
    reads: bool
    writes: bool


_formats: list[Format] = []


def formats() -> list[Format]:
    """Those of the library's table that packages in here read or write; USD has a package of its own."""
    if not _formats:
        _formats.extend(Format(*row) for row in _isoshell.python_formats() if row[1] != "usd")
    return _formats


def format_of(path: Any) -> Optional[Format]:
    """The format that a path's ending names, if any."""
    if not isinstance(path, (str, os.PathLike)):
        return None
    name = os.fsdecode(path).lower()
    return next((format for format in formats() if name.endswith("." + format.ending)), None)


def package(name: str, for_what: str) -> Any:
    """A package that may not be there.

    Raises:
        Error: of code USAGE, saying what to install.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        extra = PACKAGES[name]
        raise Error(f"{for_what} needs {name}, which cannot be imported ({error}): pip install 'isoshell[{extra}]', or "
                    f"pip install {name}") from error


def _taken_by(taker: Any, given: Any, options: dict[str, Any]) -> Any:
    try:
        return taker.taken(given, options)
    except Error:
        raise
    except Exception as error:  # whatever the package raises of an object that contradicts itself
        raise Error(f"source is a {type(given).__name__} of {type(given).__module__.partition('.')[0]}, which cannot be "
                    f"taken: {words_of(error)}", ErrorCode.UNREADABLE_INPUT, "read") from error


def to_package(module: str, made: Any) -> Any:
    """A result, or a mesh, as that module has meshes."""
    return importlib.import_module(f".{module}", __name__).given(made)


def taken(given: Any, options: dict[str, Any]) -> Any:
    """An object of another package as an isoshell.Mesh, Points, Volume or Labels; anything else as it is."""
    for kind in type(given).__mro__:
        taker = TAKERS.get(kind.__module__.partition(".")[0])
        if taker is not None:
            return _taken_by(importlib.import_module(f".{taker}", __name__), given, options)
    return given
