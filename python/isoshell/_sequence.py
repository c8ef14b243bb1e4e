"""Sequences: frames one after the other, each beginning with the one before."""

from __future__ import annotations

import os
from itertools import count
from typing import TYPE_CHECKING, Any, Callable, Iterable, Iterator, Optional, Sized, Tuple, Union

from . import _isoshell
from ._context import Context
from ._errors import Error, warn
from ._isoshell import ErrorCode
from ._keywords import keywords_of, text_of
from ._paths import Path, path_text
from ._remesh import (check_target, is_written_here, keywords_for, listener, result_of, settle, stage_files,
                      takes_true)
from ._result import Result, checked
from ._sources import SourceLike, frame_source_of, opened, sizing_of
from ._usd import file_of, is_usd

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Unpack

    from ._options import Options
    from ._usd._samples import SampledStage

Number = Union[int, float]
Frame = Tuple[Number, Callable[[], Any]]  # its number, and what makes its source

PATTERNS = ("stats", "save_shell", "save_voronoi", "save_level_set")  # beside the output


def remesh_sequence(source: Union[Path, Iterable[SourceLike]], *, frames: Optional[Union[str, int, range]] = None,
                    output: Optional[Path] = None, velocity: Optional[str] = None, no_coherence: bool = False,
                    keep_going: bool = False, resume: bool = False, context: Optional[Context] = None,
                    **options: Unpack[Options]) -> Frames:
    """Remesh the frames of a sequence, each beginning with the vertices of the one before: vertex i stays vertex i.

        for result in isoshell.remesh_sequence("cache.####.obj", frames="1-240", output="out.####.ply"):
            print(result.frame, result.report["coherence"])

    A frame is made when it is asked for, and nothing but the last one is kept. What can be checked before is checked
    by this call: missing frames, files that exist, options.

    Args:
        source: the name of files, with #### or %04d where the number is; a stage of USD with time samples, perhaps
            with a prim in it; or sources as remesh() takes them, one for each frame, from a list, a generator or any
            other iterable.
        frames: which, as "1-240", "1-240x2" for every second one, 7 or range(1, 241). Files need it. A stage has all
            its samples without it; other sources are numbered from 1.
        output: also write the frames there: a name with #### or %04d; or a stage of USD without, which holds all of
            them as time samples and is there after the last.
        velocity: the grid of .vdb files that has the velocities, world units a frame, along which vertices go to the
            next frame. An isoshell.Volume or Mesh has them by itself, and a stage of USD as `velocities`.
        no_coherence: begin every frame anew.
        keep_going: go on after a frame that cannot be read or meshed, or misses a requirement: see Frames.errors.
        resume: leave out the frames whose output is there, whole and as this call would make it, and go on after them,
            to the same bytes; others replace what is there, with a warning. In PLY.
        context, options: as remesh() takes them, but for report and split_regions; stats, save_shell, save_voronoi
            and save_level_set are names with #### or %04d.

    Returns:
        An iterator of the results.

    Raises:
        Error: as remesh() does, by this call or by the frame that it names.
    """
    given: dict[str, Any] = dict(options)
    flags = {"no_coherence": no_coherence, "keep_going": keep_going, "resume": resume}
    for name, value in flags.items():
        if not isinstance(value, bool):
            raise Error(f"{name} is {value!r}; it must be True or False", stage="options")
    return Frames(_Sequence(source, frames, output, velocity, flags, context, given))


class Frames(Iterator[Result]):
    """The results of remesh_sequence(), one after the other, with their number as `frame`.

    Closing it, or letting go of it, ends the sequence: files of the frames that were made stay, a stage of USD for all
    of them is not written. It is a context manager, which closes it.

    Attributes:
        errors: with keep_going what went wrong, by the number of the frame. The result of one that misses a requirement
            is among the others; of any other bad frame there is none.
        found: with resume the numbers of the frames so far that need not be made.
    """

    errors: dict[Number, Error]
    found: list[Number]

    def __init__(self, sequence: _Sequence) -> None:
        self.errors = sequence.errors
        self.found = sequence.found
        self._count = sequence.count
        self._results = sequence.results()

    def __iter__(self) -> Frames:
        return self

    def __len__(self) -> int:
        """How many frames there are, made or not. TypeError where the sources do not say it."""
        if self._count is None:
            raise TypeError("nobody knows how many frames there are; give frames")
        return self._count

    def __bool__(self) -> bool:
        return True

    def __next__(self) -> Result:
        return next(self._results)

    def close(self) -> None:
        """End the sequence."""
        self._results.close()  # type: ignore[attr-defined]

    def __enter__(self) -> Frames:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()


class _Sequence:
    """What was asked for, checked, and the loop over its frames."""

    def __init__(self, source: Any, frames: Any, output: Optional[Path], velocity: Optional[str],
                 flags: dict[str, bool], context: Optional[Context], options: dict[str, Any]) -> None:
        self.errors: dict[Number, Error] = {}
        self.found: list[Number] = []
        self.count: Optional[int] = None  # of frames
        self._measure_all = takes_true(options, "stats")
        self._sizing = sizing_of(options)
        self._place, self._progress = settle(context, options)
        self._options = options
        self._velocity = velocity or ""
        self._is_coherent = not flags["no_coherence"]
        self._keep_going, self._resume = flags["keep_going"], flags["resume"]
        self._target = "" if output is None else path_text(output)
        self._output = "" if is_written_here(self._target, options) else self._target  # what the library writes
        if options.get("split_regions"):
            raise Error("split_regions is for one frame; leave it out: Result.region has the regions of each",
                        stage="options")
        if self._resume and not self._output:
            raise Error("resume needs output to be a name of PLY files, as out.####.ply", stage="options")
        self._frames = self._frames_of(source, _text_of(frames))
        self._stage = self._stage_for(self._target, source)

    def results(self) -> Iterator[Result]:
        """The loop."""
        chain = _isoshell.Frames(self._is_coherent, self.count or 0)
        try:
            for index, (frame, source) in enumerate(self._frames):
                try:
                    given = source()
                    if self._is_there(chain, frame, given):
                        self.found.append(frame)
                        continue
                    result = self._made(chain, index, frame, given)
                except Error as error:
                    self._note(frame, error)
                    continue
                try:
                    checked(result)
                except Error as error:
                    self._note(frame, error)
                if self._stage is not None:
                    self._stage.add(result)
                yield result
                del source, given, result  # not to be kept while the next is made
            if self._stage is not None:
                self._stage.finish()
        finally:
            if self._stage is not None:
                self._stage.discard()

    def _made(self, chain: _isoshell.Frames, index: int, frame: Number, source: Any) -> Result:
        options = self._options_of(frame)
        source = opened(source, options)
        keywords = keywords_for(source, options)
        start = frame_source_of(source, self._sizing)
        path = _path_at(self._output, frame)
        made = chain.run(self._place, start, keywords, index, path, self._measure_all, self._velocity, self._progress,
                         listener(options))
        result = result_of(made, start, keywords, source, stage_files(options))
        result.frame = frame
        if self._target and not self._output and self._stage is None:
            result.save(_path_at(self._target, frame), overwrite=options.get("force") is True,
                        recenter=options.get("recenter"))
        return result

    def _is_there(self, chain: _isoshell.Frames, frame: Number, source: Any) -> bool:
        """Whether the frame need not be made: then the next one goes on from what is there."""
        path = _path_at(self._output, frame)
        if not self._resume or not os.path.exists(path):
            return False
        options = self._options_of(frame)
        given = opened(source, options)
        misfit = chain.go_on_from(self._place, frame_source_of(given, self._sizing), keywords_for(given, options), path,
                                  self._velocity, listener(options))
        if misfit and options.get("quiet") is not True:
            warn(f"{path} {misfit}: it is made again")
        return not misfit

    def _note(self, frame: Number, error: Error) -> None:
        """Names the frame, and ends the sequence unless it is to keep going."""
        named = Error(f"frame {frame}: {error}", error.code, error.stage, error.result)
        if error.code == ErrorCode.INTERRUPTED or not self._keep_going:
            raise named from error
        named.result = None  # the loop has it, and a long sequence should not keep all of them
        self.errors[frame] = named
        if self._options.get("quiet") is not True:
            warn(str(named))

    def _options_of(self, frame: Number) -> dict[str, Any]:
        replaced: dict[str, Any] = {"force": True} if self._resume else {}  # what is there and does not fit
        if self._options.get("grids") and isinstance(frame, int):
            names = text_of("grids", self._options["grids"]).split(",")
            replaced["grids"] = [_isoshell.grid_of_frame(name, frame) for name in names]
        return {**self._options, **replaced, **{name: _path_at(path_text(self._options[name]), frame)
                                    for name in PATTERNS if self._options.get(name)}}

    def _frames_of(self, source: Any, frames: Optional[str]) -> Iterator[Frame]:
        """The frames, checked as far as it can be done before they start."""
        if not isinstance(source, (str, os.PathLike)):
            return self._frames_of_iterable(source, frames)
        name = path_text(source)
        if is_usd(name) and not _is_pattern(name):
            return self._frames_of_stage(name, frames)
        if frames is None:
            raise Error(f"which frames of {name}? Give frames, as '1-240'", stage="frames")
        numbers = self._checked_numbers(file_of(name), frames)
        self.count = len(numbers)
        return ((n, lambda n=n: _isoshell.path_of_frame(name, n)) for n in numbers)  # type: ignore[misc]

    def _frames_of_stage(self, name: str, frames: Optional[str]) -> Iterator[Frame]:
        from ._usd._read import Scene

        if self._velocity:
            raise Error(f"velocity names a grid of .vdb files, and {name} is none; leave it out", stage="options")
        scene = Scene(name)
        times: list[Number] = [*self._checked_numbers("", frames)] if frames else scene.times()
        if not times:
            raise Error(f"{name}: nothing in it has time samples; give frames to read it at, as '1-24', or call "
                        "isoshell.remesh", stage="frames")
        if not frames:
            self._checked_numbers("", "1")
        self.count = len(times)
        return ((t, lambda t=t, until=until: scene.mesh_at(t, until))  # type: ignore[misc]
                for t, until in zip(times, [*times[1:], None]))

    def _frames_of_iterable(self, source: Any, frames: Optional[str]) -> Iterator[Frame]:
        try:
            sources = iter(source)
        except TypeError:
            raise Error("source must be a name of files with #### for the number, a stage of USD or an iterable of "
                        f"sources, one for each frame, and is {type(source).__name__}", stage="frames") from None
        numbers = self._checked_numbers("", frames or "1")
        self.count = len(numbers) if frames else len(source) if isinstance(source, Sized) else None
        return _numbered(sources, numbers if frames else None)

    def _checked_numbers(self, files: str, frames: str) -> list[int]:
        """The numbers of the frames; `files` is empty where sources are no files."""
        keywords = keywords_of(self._options)
        stage_of_all = is_usd(self._target) and not _is_pattern(self._target)
        if self._target and not self._output and not stage_of_all:
            self._check_targets(keywords, files, frames)
        return _isoshell.check_frames(keywords, files, self._output, frames, self._keep_going, self._resume)

    def _check_targets(self, keywords: Any, files: str, frames: str) -> None:
        for n in _isoshell.check_frames(keywords, "", "", frames, True, False):
            check_target(_path_at(self._target, n), self._options, [], _path_at(files, n) or None)

    def _stage_for(self, target: str, source: Any) -> Optional[SampledStage]:
        if not is_usd(target) or _is_pattern(target):
            return None
        from ._usd._samples import SampledStage

        check_target(target, self._options, [], source)
        if self._options.get("recenter") is not None:
            raise Error(f"recenter: not where all frames are {target}, whose mesh has a transform", stage="options")
        return SampledStage(target, self._options.get("force") is True)


def _numbered(sources: Iterator[Any], numbers: Optional[list[int]]) -> Iterator[Frame]:
    """Each source with its number; both must end together."""
    left = iter(numbers) if numbers is not None else count(1)
    n: Optional[int] = None
    for source in sources:
        last, n = n, next(left, None)
        if n is None:
            raise Error(f"there is a source after that of frame {last}, the last of frames", stage="frames")
        yield n, lambda given=source: given  # type: ignore[misc]
        del source  # it may be large
    if numbers is not None:
        missing = [*left]
        if missing:
            raise Error(f"the sources ended before frame {missing[0]}, and frames go on to {missing[-1]}",
                        ErrorCode.UNREADABLE_INPUT, "frames")


def _text_of(frames: Any) -> Optional[str]:
    """As the command has it."""
    if isinstance(frames, range):
        if len(frames) == 0 or frames.step < 1:
            raise Error(f"frames is {frames!r}; a range must count up, and hold a frame", stage="options")
        return f"{frames[0]}-{frames[-1]}x{frames.step}"
    if isinstance(frames, bool) or not isinstance(frames, (int, str, type(None))):
        raise Error(f"frames is {frames!r}; it must be as '1-240', '1-240x2', 7 or range(1, 241)", stage="options")
    return None if frames is None else str(frames)


def _is_pattern(path: str) -> bool:
    """Whether it has a place for the number of a frame."""
    try:
        _isoshell.path_of_frame(path, 1)
    except Error:
        return False
    return True


def _path_at(pattern: str, frame: Number) -> str:
    """A file of a frame; empty where there is none."""
    if not pattern:
        return ""
    if isinstance(frame, float):
        raise Error(f"the time code {frame} is no number for the name of a file; give frames", stage="frames")
    return _isoshell.path_of_frame(pattern, frame)
