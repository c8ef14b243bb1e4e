"""The command: python -m isoshell INPUT OUTPUT [options]."""

import os
import sys

from . import _isoshell


def main() -> int:
    """Run the command with the arguments of this process. Returns its exit status."""
    return _isoshell.command(["vdb_isomesh", *map(os.fspath, sys.argv[1:])])


if __name__ == "__main__":
    sys.exit(main())
