"""Where runs are done."""

from __future__ import annotations

from types import TracebackType
from typing import Callable, Optional, Union

from . import _isoshell
from ._keywords import keywords_of


class Progress(float):
    """How far a call is: the fraction of all of it that is done, from 0 to 1. It never goes back.

    Attributes:
        stage_fraction: of the stage that goes on, likewise.
        seconds_left: about.
    """

    stage_fraction: float
    seconds_left: float

    def __new__(cls, fraction: float, stage_fraction: float, seconds_left: float) -> Progress:
        progress = super().__new__(cls, fraction)
        progress.stage_fraction, progress.seconds_left = stage_fraction, seconds_left
        return progress

    def __getnewargs__(self) -> tuple[float, float, float]:  # type: ignore[override]
        return float(self), self.stage_fraction, self.seconds_left


def memory_bytes_of(max_memory: Optional[Union[int, str]]) -> int:
    """As the command takes it; 0 for none.

    Raises:
        Error: of code USAGE for a value that cannot be.
    """
    return _isoshell.memory_limit(keywords_of({"max_memory": max_memory}))


OnProgress = Callable[[str, Progress], object]


class Context:
    """The device, threads and memory of runs, kept from one to the next; a context manager.

    One run at a time: give each thread its own. A device stays in use until the context is closed.

    Args:
        device: "auto", "cpu", "cuda" or "cuda:N".
        threads: number of CPU threads; all without it.
        max_memory: refuse a run that would need more, as "512M", "8G" or bytes; without it 80 % of what is free.
        progress: called as progress(stage, fraction) by the thread that asked for the run, a few times a second. The
            fraction is a Progress, of the whole run or sequence. What it raises stops the run, and is raised there.

    Raises:
        Error: of code USAGE for a value that cannot be.
    """

    progress: Optional[OnProgress]

    def __init__(self, *, device: Optional[str] = None, threads: Optional[int] = None,
                 max_memory: Optional[Union[int, str]] = None, progress: Optional[OnProgress] = None) -> None:
        self._place = _isoshell.Place(keywords_of({"device": device, "threads": threads, "max_memory": max_memory}))
        self.progress = progress

    def cancel(self) -> None:
        """Stop the run that is going on: it raises Error of code INTERRUPTED. From any thread."""
        self._place.cancel()

    def close(self) -> None:
        """Let go of the device. A later run takes it again.

        Raises:
            Error: of code USAGE while a run is going on.
        """
        self._place.close()

    def __enter__(self) -> Context:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()
