"""Keywords of Python as options of the command, which one parser reads."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, List, NamedTuple, Optional, Tuple

from . import _isoshell
from ._errors import Error
from ._paths import path_text

Keywords = List[Tuple[str, Optional[str]]]

PLACE = ("device", "threads", "max_memory")  # of a Context
READING = ("iso", "background", "smallest-island", "smoothing", "periodic", "union", "reference", "input-format", "features")  # what decides how a source is read
INSTEAD = {  # of options that only the command has
    "help": "see help(isoshell.Options)",
    "version": "see isoshell.__version__",
    "dry_run": "call isoshell.estimate",
    "output": "isoshell.remesh, remesh_many and remesh_sequence have it as a parameter",
}
PLACES = ("recenter",)  # of three numbers
OF_SEQUENCES = "sequences are meshed by isoshell.remesh_sequence"

class Kind(NamedTuple):
    is_flag: bool
    of_command: bool  # no keyword
    is_whole: bool  # takes whole numbers alone
    repeats: bool  # its text has a line for each time that it is given


_kinds: dict[str, Kind] = {}


def kinds() -> dict[str, Kind]:
    """Every option of the command by its keyword."""
    if not _kinds:
        _kinds.update({entry.name.replace("-", "_"): Kind(not entry.value, entry.of_command,
                                                         not entry.real and entry.low < entry.high, entry.repeats)
                       for entry in _isoshell.option_table()})
    return _kinds


def is_flag(name: str) -> bool:
    """Whether that is an option without a value."""
    return name in kinds() and kinds()[name].is_flag


def keywords_of(options: dict[str, Any]) -> Keywords:
    """The options as the parser takes them; None is as if it were not there."""
    words: Keywords = []
    for name, given in options.items():
        value = _plain(given)
        kind = kinds().get(name)
        if kind is not None and kind.of_command:
            raise Error(f"{name} is no keyword; {INSTEAD.get(name, OF_SEQUENCES)}", stage="options")
        option = name.replace("_", "-")
        if "-" in name:
            raise Error(f"unknown option {name}; did you mean {name.replace('-', '_')}?", stage="options")
        if kind is None and name == "faces" and _is_array(value):
            raise Error("faces is no keyword; give vertices and faces by position: remesh(V, F)", stage="options")
        if kind is None:
            words.append((option, None))  # the parser refuses it, and knows the nearest name
        elif value is None:
            continue
        elif not kind.is_flag:
            text = text_of(name, _whole(value) if kind.is_whole or name == "max_memory" else value)
            if text:
                words.append((option, text))
        elif not isinstance(value, bool):
            raise Error(f"{name} is {value!r}; it must be True or False", stage="options")
        elif value:
            words.append((option, None))
    return words


def _is_array(value: Any) -> bool:
    return isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) > 0


def _plain(value: Any) -> Any:
    """A scalar of numpy as Python's own."""
    return value.item() if hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0 else value


def _whole(value: Any) -> Any:
    """1e3 as 1000; any other number as it is."""
    return int(value) if isinstance(value, float) and value.is_integer() and abs(value) < 2**63 else value


def whole_number_of(name: str, value: Any) -> int:
    """An option that is used here, and not by the parser.

    Raises:
        Error: of code USAGE for what is no whole number.
    """
    try:
        return int(text_of(name, _whole(_plain(value))))
    except ValueError:
        raise Error(f"{name} is {value!r}; it must be a whole number", stage="options") from None


def text_of(name: str, given: Any) -> str:
    """A value as the command takes it; None is empty."""
    value = _plain(given)
    if value is None:
        return ""
    if isinstance(value, (float, int)) and not isinstance(value, bool):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return path_text(value)
    if name == "grids" and isinstance(value, Mapping):
        raise Error("grids in memory are those of one run: give them to isoshell.remesh, and name grids of files here",
                    stage="options")
    if isinstance(value, Mapping):  # an option of the command that may be given more than once
        return "\n".join(f"{_key(name, key)}={_plain(part)!r}" for key, part in value.items())
    if isinstance(value, (list, tuple)) and all(isinstance(part, str) for part in value):
        return "none" if name == "attributes" and not value else ",".join(map(path_text, value))
    if name in PLACES and hasattr(value, "__len__") and len(value) == 3:
        return ",".join(text_of(name, number) for number in value)
    raise Error(f"{name} is {value!r}; it must be a number, text or a list of texts", stage="options")


def _key(name: str, key: Any) -> str:
    plain = _plain(key)
    if isinstance(plain, (str, int)) and not isinstance(plain, bool) and "\n" not in str(plain):
        return path_text(str(plain))
    raise Error(f"a key of {name} is {key!r}; it must be a label or a name", stage="options")
