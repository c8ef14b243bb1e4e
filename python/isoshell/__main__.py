"""The command: python -m isoshell INPUT OUTPUT [options], and what else its first word may name (_command.py)."""

import os
import sys

from . import _isoshell
from ._command import run_one_of
from ._exchange import format_of
from ._report import has_k3d, write_of_command
from ._usd import ENDINGS

STAGE = f"or a stage of USD ({' '.join(ENDINGS)})"


def main() -> int:
    """Run the command with the arguments of this process. Returns its exit status."""
    return run_one_of([*map(os.fspath, sys.argv[1:])], remesh)


def remesh(words: list[str]) -> int:
    """The command vdb_isomesh, and where INPUT or OUTPUT is a file that Python reads and writes, what stands for it."""
    if any(".usd" in word.lower() or format_of(word) is not None for word in words):
        from ._usd._command import names_ours, run

        if names_ours(words):
            return run(words)
    return _isoshell.command(["isoshell remesh", *words], write_of_command if has_k3d() else None,
                             f"{STAGE}; FILE:/PRIM names one of its prims", STAGE)


if __name__ == "__main__":
    sys.exit(main())
