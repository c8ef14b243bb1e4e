"""What reading and writing USD share: names of files, the library, and what a scene says beside its meshes."""

from __future__ import annotations

import importlib
import os
import re
from typing import Any, Optional

from .._errors import Error
from .._isoshell import ErrorCode, python_formats
from .._paths import path_text

ENDINGS = tuple(f".{ending}" for ending, extra, _, _ in python_formats() if extra == "usd")
NAMED = re.compile(r"(?P<file>.*\.usd[acz]?)(?::(?P<prim>[^:\\]*))?", re.IGNORECASE | re.DOTALL)
MODULES = ("Gf", "Sdf", "Tf", "Usd", "UsdGeom", "UsdShade", "UsdSkel", "UsdUtils", "UsdVol", "Vt")


class Origin:
    """What a scene says beside its meshes; a result keeps it, and writes it again.

    Attributes:
        up_axis: "Y" or "Z"; nothing is ever turned.
        meters_per_unit: metres in a unit of the coordinates.
        name: of the mesh.
        root: of the prim that holds everything.
        uv_sets: the primvars that the attributes uv, uv1, uv2 and so on come from.
        vectors: by name the USD type of attributes that come apart into name.0, name.1 and so on.
        constants: names of attributes that have one value for all.
        materials: a layer of USD, as text, with the materials by their labels below /Materials.
        time_codes_per_second: how long a time code is; of a sequence a frame is one.
    """

    def __init__(self, up_axis: str = "Y", meters_per_unit: float = 1.0, name: str = "mesh", root: str = "World",
                 time_codes_per_second: float = 24.0) -> None:
        self.up_axis = up_axis
        self.meters_per_unit = meters_per_unit
        self.name = name
        self.root = root
        self.uv_sets: list[str] = []
        self.vectors: dict[str, str] = {}
        self.constants: set[str] = set()
        self.materials = ""
        self.time_codes_per_second = time_codes_per_second


def is_usd(path: Any) -> bool:
    """Whether a path names a USD file, perhaps with a prim in it."""
    return isinstance(path, (str, os.PathLike)) and NAMED.fullmatch(path_text(path)) is not None


def split_name(path: str | os.PathLike[str]) -> tuple[str, Optional[str]]:
    """FILE.usd:/PRIM as file and prim, or None without one."""
    found = NAMED.fullmatch(path_text(path))
    if found is None:
        raise Error(f"{path_text(path)}: the ending must be one of {', '.join(ENDINGS)}")
    return found["file"], found["prim"]


def file_of(path: str | os.PathLike[str]) -> str:
    """The file that a source names, without a prim in it."""
    return split_name(path)[0] if is_usd(path) else path_text(path)


def library() -> Any:
    """The package pxr with the modules used here.

    Raises:
        Error: of code USAGE, saying what to install.
    """
    try:
        package = importlib.import_module("pxr")
        for name in MODULES:
            importlib.import_module(f"pxr.{name}")
    except ImportError as error:
        raise Error(f"USD files need usd-core, which cannot be imported ({error}): pip install 'isoshell[usd]', or "
                    "pip install usd-core", stage="usd") from error
    return package


def unreadable(place: str, what: str) -> Error:
    """The error of a file that cannot be read."""
    return Error(f"{place}: {what}", ErrorCode.UNREADABLE_INPUT, "read")


def reason_of(error: Exception) -> str:
    """What USD says of its errors, in one line and without where in its sources that was."""
    try:  # pxr.Tf.ErrorException has its errors as arguments
        texts = [str(getattr(part, "commentary", part)) for part in error.args] or [str(error)]
    except UnicodeDecodeError:  # it quotes the file
        return "it is damaged"
    return " ".join("; ".join(texts).split())
