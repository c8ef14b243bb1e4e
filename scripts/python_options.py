#!/usr/bin/env python3
"""Prints python/isoshell/_options.py, made from the command's option table. With --update, writes it.

Needs the module that is built: PYTHONPATH=build/cpu/python/isoshell scripts/python_options.py --update
"""

import sys
import textwrap
from pathlib import Path

import _isoshell

TARGET = Path(__file__).resolve().parent.parent / "python/isoshell/_options.py"
HEAD = '''"""Keywords of isoshell.remesh. Made by scripts/python_options.py from the option table of the command."""

from __future__ import annotations

from typing import Any, Callable, Literal, Mapping, Optional, Sequence, TypedDict, Union

from ._context import Progress
from ._paths import Path


class Options(TypedDict, total=False):
    """The options of the command vdb_isomesh, with underscores. None is as if a keyword were not there; what holds then
    is in brackets.
'''
SPECIAL = {
    "features": "Union[float, str]",
    "close-gaps": "Union[float, str]",
    "attributes": "Union[str, Sequence[str]]",
    "grids": "Union[str, Sequence[str], Mapping[str, Any]]",
    "recenter": "Union[str, Sequence[float]]",
    "require": "Union[str, Sequence[str]]",
    "max-memory": "Union[int, str]",
    "regions": "str",
    "periodic": "str",
    "device": "str",
    "input-format": "str",
    "output-format": "str",
    "sizing": "Any",
    "region-edge-length": "Mapping[Union[int, str], float]",
    "reference": "Path",
    "save-level-set": "Union[bool, Path]",
    "stats": "Union[bool, Path]",
}

WHOLE_NUMBERS = ("K", "R", "D", "N", "LABEL")  # what option tables call them


def type_of(option: _isoshell.OptionEntry) -> str:
    if option.name in SPECIAL:
        return SPECIAL[option.name]
    if not option.value:
        return "bool"
    if option.real:
        return "float"
    if option.value.startswith("F.") or option.value == "DIR":
        return "Path"
    if "|" in option.value:
        words = ", ".join(f'"{word}"' for word in option.value.split("|"))
        words = f"Literal[{words}]"
        return f"Union[{words}, Callable[[str, Progress], object]]" if option.name == "progress" else words
    if option.value not in WHOLE_NUMBERS:
        raise SystemExit(f"--{option.name} takes {option.value}, whose type is not known: name it in SPECIAL")
    return "int"


def text_of(option: _isoshell.OptionEntry) -> str:
    text = _isoshell.in_keywords(option.text)
    fallback = "no bar" if option.name == "progress" else option.fallback
    return text + (f" [{fallback}]" if fallback else "") + "."


def options_file() -> str:
    options = [option for option in _isoshell.option_table() if not option.of_command]
    text, group, members = HEAD, "", ""
    for option in options:
        keyword, kind = option.name.replace("-", "_"), type_of(option)
        if option.group != group:
            group = option.group
            text += f"\n    {group}:\n"
        text += textwrap.fill(f"{keyword}: {text_of(option)}", 120, initial_indent=8 * " ", subsequent_indent=12 * " ")
        text += "\n"
        members += f"    {keyword}: {kind if kind in ('bool', 'Any') else f'Optional[{kind}]'}\n"
    return f'{text}    """\n\n{members}'


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        TARGET.write_text(options_file())
    else:
        print(options_file(), end="")
