"""The command: python -m isoshell INPUT OUTPUT [options], and what else its first word may name (_command.py)."""

import os
import sys

from . import _isoshell
from ._command import files_of_packages, run_one_of, that_are_read
from ._exchange import format_of, formats
from ._report import has_k3d, write_of_command


def main() -> int:
    """Run the command with the arguments of this process. Returns its exit status."""
    return run_one_of([*map(os.fspath, sys.argv[1:])], remesh)


def remesh(words: list[str]) -> int:
    """The command vdb_isomesh, and where INPUT or OUTPUT is a file that Python reads and writes, what stands for it."""
    if any(".usd" in word.lower() or format_of(word) is not None or word.startswith("--fill") for word in words):
        from ._remesh_command import names_ours, run

        if names_ours(words):
            return run(words)
    return _isoshell.command(["isoshell remesh", *words], write_of_command if has_k3d() else None,
                             that_are_read(), files_of_packages("", [each.ending for each in formats() if each.writes]))


if __name__ == "__main__":
    sys.exit(main())
