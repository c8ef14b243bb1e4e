"""How far a farm is, for people."""

from __future__ import annotations

import sys
import time
from typing import Any, Dict

SECONDS_OF_TERMINAL = 0.2
SECONDS_OF_LOG = 10.0


def tell(text: str) -> None:
    print(f"isoshell farm: {text}", file=sys.stderr, flush=True)


class Progress:
    """One line that is written again on a terminal, otherwise a line now and then."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = self._failed = 0
        self._start = self._shown = time.monotonic()
        self._is_terminal = sys.stderr.isatty()
        self._is_drawn = False

    def count(self, row: Dict[str, Any]) -> None:
        self._done += 1
        self._failed += row["state"] == "failed"

    def show(self) -> None:
        now = time.monotonic()
        if now - self._shown < (SECONDS_OF_TERMINAL if self._is_terminal else SECONDS_OF_LOG):
            return
        self._shown = now
        if self._is_terminal:
            print(f"\r\x1b[K{self._line(now)}", end="", file=sys.stderr, flush=True)
            self._is_drawn = True
        else:
            tell(self._line(now))

    def end(self) -> None:
        if self._is_drawn:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
            self._is_drawn = False

    def _line(self, now: float) -> str:
        rate = self._done / max(now - self._start, 1e-9)
        text = f"{self._done} of {self._total} assets"
        if self._failed:
            text += f", {self._failed} failed"
        if self._done:
            text += f", {rate:.2g} a second, about {duration((self._total - self._done) / rate)} left"
        return text


def duration(seconds: float) -> str:
    """As people say it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    if seconds < 5400:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
