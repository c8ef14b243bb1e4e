"""Names of files, and errors of writing them."""

from __future__ import annotations

import contextlib
import os
from typing import Callable, Iterator, Type, Union

from ._errors import Error, words_of
from ._isoshell import ErrorCode

Path = Union[str, os.PathLike[str]]


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


@contextlib.contextmanager
def writing(path: str, failure: Type[Exception] = Exception,
            reason_of: Callable[[Exception], str] = words_of) -> Iterator[None]:
    """What fails meanwhile is an Error of code UNWRITABLE_OUTPUT: OSError, and `failure`, what a package raises of it,
    which says by `reason_of` why."""
    try:
        yield
    except Error:
        raise
    except OSError as error:
        raise unwritable(path, words_of(error)) from error
    except failure as error:
        raise unwritable(path, reason_of(error)) from error


def unwritable(path: str, what: str) -> Error:
    """The error of a file that cannot be written."""
    return Error(f"{path}: {what}", ErrorCode.UNWRITABLE_OUTPUT, "write")
