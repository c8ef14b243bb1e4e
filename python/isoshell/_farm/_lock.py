"""Keeps a second run out of an OUT that one is at work on."""

from __future__ import annotations

import errno
import fcntl
import os
import socket
from contextlib import contextmanager
from typing import Iterator

from .._errors import Error
from .._isoshell import ErrorCode
from . import _manifest as manifest
from . import _places as places
from ._progress import tell

CANNOT_LOCK = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


@contextmanager
def locked(out: str) -> Iterator[None]:
    """The system takes the lock back however this process ends. Object storage has none. Raises Error where another
    run has it."""
    if places.is_remote(out):
        yield
        return
    folder = places.join(out, manifest.FOLDER)
    try:
        os.makedirs(folder, exist_ok=True)
        handle = os.open(places.join(folder, "lock"), os.O_RDWR | os.O_CREAT, 0o666)
        _take(handle, out)
    except OSError as error:
        raise Error(f"{error.filename or out}: {error.strerror}", ErrorCode.UNWRITABLE_OUTPUT, "farm") from error
    try:
        yield
    finally:
        os.close(handle)


def _take(handle: int, out: str) -> None:
    """And say who has it."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        holder = os.pread(handle, 1000, 0).decode(errors="replace") or "another process"
        raise Error(f"{out}: another farm is at work there: {holder}; wait until it ends, or give another OUT",
                    ErrorCode.UNWRITABLE_OUTPUT, "farm") from error
    except OSError as error:
        if error.errno not in CANNOT_LOCK:
            raise
        tell(f"warning: {out}: the file system has no locks; see that no second farm works there")
    os.ftruncate(handle, 0)
    os.pwrite(handle, f"process {os.getpid()} of {socket.gethostname()}".encode(), 0)
