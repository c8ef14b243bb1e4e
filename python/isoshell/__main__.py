"""The command: python -m isoshell INPUT OUTPUT [options], and what else its first word may name (_command.py)."""

import os
import sys

from . import _isoshell
from ._command import run_one_of
from ._exchange import format_of, formats
from ._report import has_k3d, write_of_command
from ._usd import ENDINGS


def main() -> int:
    """Run the command with the arguments of this process. Returns its exit status."""
    return run_one_of([*map(os.fspath, sys.argv[1:])], remesh)


def remesh(words: list[str]) -> int:
    """The command vdb_isomesh, and where INPUT or OUTPUT is a file that Python reads and writes, what stands for it."""
    if any(".usd" in word.lower() or format_of(word) is not None for word in words):
        from ._remesh_command import names_ours, run

        if names_ours(words):
            return run(words)
    return _isoshell.command(["isoshell remesh", *words], write_of_command if has_k3d() else None,
                             _also("; FILE:/PRIM names a prim", [each.ending for each in formats() if each.reads]),
                             _also("", [each.ending for each in formats() if each.writes]))


def _also(of_stages: str, endings: list[str]) -> str:
    """What the help says of files beside those of the command."""
    names = " ".join(f".{ending}" for ending in endings)
    return f"or a stage of USD ({' '.join(ENDINGS)}{of_stages}), or a file by other Python packages\n        ({names})"


if __name__ == "__main__":
    sys.exit(main())
