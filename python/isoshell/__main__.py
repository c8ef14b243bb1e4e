"""The command: python -m isoshell INPUT OUTPUT [options], and isoshell farm, which meshes many assets."""

import os
import sys

from . import _isoshell
from ._exchange import format_of
from ._report import has_k3d, write_of_command

FARM = ("run", "status", "report")


def main() -> int:
    """Run the command with the arguments of this process. Returns its exit status."""
    words = [*map(os.fspath, sys.argv[1:])]
    if words[:1] == ["farm"] and words[1:2] and (words[1] in FARM or words[1] in ("-h", "--help")):
        from ._farm._command import main as farm

        return farm(words[1:])
    if any(".usd" in word.lower() or format_of(word) is not None for word in words):
        from ._usd._command import names_ours, run

        if names_ours(words):
            return run(words)
    return _isoshell.command(["vdb_isomesh", *words], write_of_command if has_k3d() else None)


if __name__ == "__main__":
    sys.exit(main())
