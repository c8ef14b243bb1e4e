"""What goes wrong, and what people are warned of."""

from __future__ import annotations

import sys
import warnings
from typing import TYPE_CHECKING, Any

from ._isoshell import ErrorCode

if TYPE_CHECKING:
    from ._result import Result


class Error(Exception):
    """An isoshell function failed; the message names the value, the limit and the remedy.

    Attributes:
        code: what went wrong, an ErrorCode: the exit status that the command has then.
        stage: where, such as "arguments", "read" or "relax".
        result: of code GATE_FAILED the mesh that a run made and that does not meet its requirements, otherwise None.
        info: of code GATE_FAILED what mesh_info() has measured of the mesh that does not, otherwise None.
    """

    code: ErrorCode
    stage: str
    result: Result | None
    info: dict[str, Any] | None

    def __init__(self, message: str, code: ErrorCode = ErrorCode.USAGE, stage: str = "arguments",
                 result: Result | None = None, info: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.stage = stage
        self.result = result
        self.info = info

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.code, self.stage, self.result, self.info)


class RunWarning(UserWarning):
    """What a person should look at: the command writes the same behind "warning:"."""


def words_of(error: BaseException) -> str:
    """What another package, or the system, says of an error, in one line."""
    return getattr(error, "strerror", None) or " ".join(str(error).split()) or type(error).__name__


def warn(text: str) -> None:
    """A warning at the line that called this package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _is_ours(frame.f_globals.get("__package__")):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, RunWarning, stacklevel=level)


def note(text: str) -> None:
    """What is good to know: to the logger "isoshell"."""
    import logging

    logging.getLogger("isoshell").info("%s", text)


def _is_ours(package: str | None) -> bool:
    """Whether that is this package or one in it; programs have none."""
    return package is not None and package.partition(".")[0] == __package__
