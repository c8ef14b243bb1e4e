"""Many runs side by side, whose results come in the order of their sources."""

from __future__ import annotations

import os
from collections import deque
from itertools import islice
from typing import (TYPE_CHECKING, Any, Generator, Generic, Iterable, Iterator, Literal, Optional, Sized, TypeVar, Union,
                    overload)

from . import _isoshell
from ._errors import Error
from ._keywords import keywords_of
from ._remesh import keywords_for, listener, result_of, takes_true
from ._inputs import Points, Volume
from ._result import Result, checked
from ._sources import SourceLike, opened, sizing_of, source_of

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Unpack

    from ._options import Options

OF_ONE_RUN = ("save_shell", "save_voronoi", "save_level_set", "level_set_half", "level_set_of", "level_set_band",
              "split_regions", "stats", "report", "progress")
MOST_WORKERS = 4096
MOST_OF_A_WORKER = 4  # sources that were read and whose results were not handed out yet


Outcome = TypeVar("Outcome", bound=Union[Result, Error])


class Results(Iterator[Outcome], Generic[Outcome]):
    """The results of remesh_many(), in the order of the sources; a progress bar such as tqdm's counts them.

    Closing it, or letting go of it, stops the workers. It is a context manager, which closes it.
    """

    def __init__(self, results: Generator[Outcome, None, None], count: Optional[int]) -> None:
        self._results = results
        self._count = count

    def __iter__(self) -> Results[Outcome]:
        return self

    def __next__(self) -> Outcome:
        return next(self._results)

    def __len__(self) -> int:
        """How many sources there are. TypeError where they do not say it, as a generator's."""
        if self._count is None:
            raise TypeError("nobody knows how many sources there are; give a list of them")
        return self._count

    def __bool__(self) -> bool:
        return True

    def close(self) -> None:
        """Stop the workers."""
        self._results.close()

    def __enter__(self) -> Results[Outcome]:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


@overload
def remesh_many(sources: Iterable[SourceLike], *, workers: Optional[int] = None, on_error: Literal["raise"] = "raise",
                **options: Unpack[Options]) -> Results[Result]: ...


@overload
def remesh_many(sources: Iterable[SourceLike], *, workers: Optional[int] = None, on_error: Literal["return"],
                **options: Unpack[Options]) -> Results[Union[Result, Error]]: ...


def remesh_many(sources: Iterable[SourceLike], *, workers: Optional[int] = None, on_error: str = "raise",
                **options: Unpack[Options]) -> Results[Any]:
    """Remesh many sources side by side: the results of remesh(), in the order of the sources.

        for result in isoshell.remesh_many(paths, vertices=4000):
            result.save(...)

    Small meshes fill a machine, or a device, only that way. Sources are read as they are needed, a few a worker before
    their results are asked for, so there may be any number of them. Closing the iterator, letting go of it and Ctrl-C
    stop the workers.

    Args:
        sources: an iterable of what remesh() takes; read by the thread that asks for results. What it raises is raised
            at once.
        workers: how many runs are made at a time, each on a thread and with a context of its own; without it as many as
            there are cores, or 8 on a device.
        on_error: "raise" the Error of the first bad source, named by its number from 0, where its result would come; or
            "return" it in the place of the result, and go on.
        options: as remesh() takes them, but for context and what is of one run: output, save_shell, save_voronoi,
            save_level_set and the other options of level sets, split_regions, report, progress, and stats as a file.
            threads is of each worker, one on the CPU without it; max_memory is of each run.

    Returns:
        An iterator of the results, with a length where the sources have one.

    Raises:
        Error: for an argument that cannot be, by this call; otherwise as remesh() does, where a result is asked for:
            whatever is wrong with a source is one, and none is a ValueError.
    """
    given: dict[str, Any] = dict(options)
    measure_all = takes_true(given, "stats")
    refused = [name for name in OF_ONE_RUN if given.get(name) is not None]
    if refused:
        raise Error(f"{', '.join(refused)}: not where many are meshed; leave it out", stage="options")
    if on_error not in ("raise", "return"):
        raise Error(f"on_error is {on_error!r}; it must be 'raise' or 'return'", stage="options")
    if workers is not None and (type(workers) is not int or not 1 <= workers <= MOST_WORKERS):
        raise Error(f"workers is {workers!r}; it must be a whole number from 1 to {MOST_WORKERS}", stage="options")
    if isinstance(sources, (str, os.PathLike)) or not isinstance(sources, Iterable):
        raise Error("sources must be an iterable of sources, such as a list of paths, and is "
                    f"{type(sources).__name__}; one source is for isoshell.remesh", stage="arguments")
    sizing = sizing_of(given)
    if sizing is not None and not isinstance(sizing, Volume):
        raise Error("sizing as an array is for one mesh; name an attribute that the vertices of each have", stage="options")
    if sizing is not None:
        source_of(Points([[0.0, 0.0, 0.0]]), sizing)  # refuses what cannot be a field, before there is a source
    crew = _isoshell.RunWorkers(keywords_of(given), workers or 0)

    runs = (_Run(crew, source, sizing, given, measure_all) for source in sources)
    return Results(_results(crew, runs, on_error == "raise"), len(sources) if isinstance(sources, Sized) else None)


class _Run:
    """One of them: waiting for a worker, at work, or ended."""

    def __init__(self, crew: _isoshell.RunWorkers, source: Any, sizing: Any, options: dict[str, Any],
                 measure_all: bool) -> None:
        self._refusal: Optional[Error] = None
        try:
            options = dict(options)
            self._source = opened(source, options)
            self._keywords = keywords_for(self._source, options)
            self._start = source_of(self._source, sizing)
            named = os.fsdecode(source) if isinstance(source, (str, os.PathLike)) else ""
            self._begun = crew.begin(self._start, self._keywords, measure_all, listener(options, named))
        except Error as error:
            self._refusal = error

    def has_ended(self) -> bool:
        return self._refusal is not None or self._begun.has_ended()

    def outcome(self) -> Union[Result, Error]:
        """Waits for it."""
        if self._refusal is not None:
            return self._refusal
        try:
            return checked(result_of(self._begun.result(), self._start, self._keywords, self._source, []))
        except Error as error:
            return error


def _results(crew: _isoshell.RunWorkers, runs: Iterator[_Run],
             raises: bool) -> Generator[Union[Result, Error], None, None]:
    """Begins the next run while there is room for it and the oldest has not ended; otherwise hands that out."""
    most = MOST_OF_A_WORKER * crew.count
    waiting: deque[_Run] = deque()
    number, has_more = 0, True
    try:
        while has_more or waiting:
            if has_more and len(waiting) < most and not (waiting and waiting[0].has_ended()):
                begun = [*islice(runs, 1)]
                has_more = bool(begun)
                waiting.extend(begun)
                continue
            outcome = waiting.popleft().outcome()
            if raises and isinstance(outcome, Error):
                raise Error(f"source {number}: {outcome}", outcome.code, outcome.stage, outcome.result) from outcome
            number += 1
            yield outcome
            del outcome  # not to be kept while others are made
    finally:
        crew.close()
