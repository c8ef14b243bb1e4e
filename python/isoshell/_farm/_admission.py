"""Memory that assets in flight may take together."""

from __future__ import annotations

import re
import threading
from collections import deque
from contextlib import contextmanager
from typing import Deque, Iterator, Optional

from .._errors import Error
from . import _places as places

PART_OF_FREE = 0.8
UNITS = {"": 1, "K": 1 << 10, "M": 1 << 20, "G": 1 << 30, "T": 1 << 40}


class Admission:
    """Hands out shares of a fixed number of bytes, in the order of asking, so that a large asset gets its turn."""

    def __init__(self, total_bytes: int) -> None:
        self.total_bytes = total_bytes
        self._free = total_bytes
        self._waiting: Deque[object] = deque()
        self._changed = threading.Condition()

    @contextmanager
    def share(self, count: int) -> Iterator[None]:
        """Waits until so many bytes, at most all of them, are free."""
        count, ticket = min(count, self.total_bytes), object()
        with self._changed:
            self._waiting.append(ticket)
            self._changed.wait_for(lambda: self._waiting[0] is ticket and self._free >= count)
            self._waiting.popleft()
            self._free -= count
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._free += count
                self._changed.notify_all()


def memory_of_node() -> int:
    """Bytes that a farm may use here: four fifths of what is free, or of what a group of processes is allowed."""
    free = int(places.package("psutil").virtual_memory().available)
    return int(PART_OF_FREE * min(free, int(places.package("distributed.system").MEMORY_LIMIT)))


def bytes_of(option: str, text: str) -> int:
    """Of 512M or 8G."""
    parsed = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?", text.strip(), re.IGNORECASE)
    count = int(float(parsed[1]) * UNITS[parsed[2].upper()]) if parsed else 0
    if count < 1:
        raise Error(f"{option} is {text!r}; it must be a size above 0, such as 512M or 8G", stage="command line")
    return count


def text_of(count: Optional[float]) -> str:
    """A number of bytes as people read it."""
    if count is None:
        return "–"
    for unit in ("B", "KB", "MB", "GB"):
        if count < 1024:
            break
        count /= 1024
    else:
        unit = "TB"
    return f"{count:.0f} {unit}" if count >= 10 or unit == "B" else f"{count:.1f} {unit}"
