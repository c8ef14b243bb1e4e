"""Names of files."""

from __future__ import annotations

import os
from typing import Union

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


def path_text(path: Path) -> str:
    """A path as text.

    Raises:
        ValueError: for a NUL in it, at which the system would end the name, as open() does.
    """
    text = os.fsdecode(path)
    if "\0" in text:
        raise ValueError(f"{text!r}: a path cannot hold a NUL character")
    return text
