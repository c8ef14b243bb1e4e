"""Names of files."""

from __future__ import annotations

import os
from typing import Union

from ._errors import Error

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


def path_text(path: Path) -> str:
    """A path, or another value of an option, as text.

    Raises:
        Error: of code USAGE for a NUL in it, at which the system would end the name; and as encodable() does.
    """
    text = encodable(os.fsdecode(path))
    if "\0" in text:
        raise Error(f"{text!r}: a path cannot hold a NUL character")
    return text


def encodable(text: str) -> str:
    """Text that the library can be given: bytes of a name that are no characters may be in it.

    Raises:
        Error: of code USAGE for half a character.
    """
    try:
        os.fsencode(text)
    except UnicodeEncodeError as error:
        raise Error(f"{text!r} cannot be encoded: it has {text[error.start]!r}, which is half a character") from None
    return text
