"""The command where INPUT or OUTPUT is a file that only Python reads or writes, a stage of USD or of another package, and
with --fill FILE, which writes tetrahedra too, made by --fill-mesher tetgen or gmsh."""

from __future__ import annotations

import json
import logging
import re
import sys
import time
import warnings
from typing import Any, Optional, Union

from ._errors import Error, RunWarning
from ._exchange import format_of
from ._fill import MESHERS, check_target
from ._isoshell import VERSION, ErrorCode
from ._keywords import kinds
from ._remesh import estimate, remesh
from ._result import Result
from ._sequence import Frames, remesh_sequence
from ._usd import is_usd

PROGRAM = "isoshell remesh"
OF_FILLING = ("fill", "fill_mesher")  # options of this command alone
OF_FRAMES = ("velocity", "no_coherence", "keep_going", "resume")
SHORT = {"-v": "--verbose", "-q": "--quiet", "-h": "--help", "-V": "--version", "-o": "--output"}


def names_ours(words: list[str]) -> bool:
    """Whether INPUT or OUTPUT is one, and nobody asks for the help."""
    places, options = split_words(words)
    places += [options["output"]] if options.get("output") else []
    says_format = ["input_format"] * max(1, len(places) - 1) + ["output_format"]
    is_ours = any(name in options for name in OF_FILLING) or any(is_usd(place) for place in places) or any(
        format_of(place) is not None and not options.get(option) for place, option in zip(places, says_format))
    return is_ours and not {"help", "version"} & set(options)


def split_words(words: list[str]) -> tuple[list[str], dict[str, Any]]:
    """The places that are no options, and the options as keywords, not checked; a named OUTPUT is one of these."""
    places: list[str] = []
    options: dict[str, Any] = {}
    left = [*words]
    while left:
        word = _long(left.pop(0), left)
        if not word.startswith("--"):
            places.append(word)
            continue
        option, is_joined, value = word[2:].partition("=")
        name = option.replace("-", "_")
        kind = kinds().get(name)
        if not is_joined and name not in OF_FILLING and (kind is None or kind.is_flag):
            options[name] = True
            continue
        text = value if is_joined else left.pop(0) if left else ""
        options[name] = f"{options[name]}\n{text}" if kind is not None and kind.repeats and name in options else text
    return places, options


def has_inputs_alone(places: list[str], options: dict[str, Any]) -> bool:
    """Whether the last place is no OUTPUT, as in the command: nothing is written, and there is one place, or it is a
    volume behind others, which is no OUTPUT of a run to a mesh."""
    if not options.get("dry_run") or not places:
        return False
    return len(places) == 1 or ("stop_after" not in options and is_volume(places[0]) and is_volume(places[-1]))


def is_volume(place: str) -> bool:
    """Whether its name is that of a volume, perhaps with one of its grids."""
    return re.search(r"\.n?vdb(:[^/]*)?$", place, re.IGNORECASE) is not None


def _long(word: str, left: list[str]) -> str:
    """The word, a short option as its long name; what stands behind it, as in -qv or -oFILE, is left."""
    option = SHORT.get(word[:2])
    if option is not None and word[2:]:
        left.insert(0, word[2:] if option == "--output" else f"-{word[2:]}")
    return option or word


def run(words: list[str]) -> int:
    """Run the command. Returns its exit status."""
    places, options = split_words(words)
    if options.get("verbose"):
        logging.basicConfig(format=f"{PROGRAM}: %(message)s", level=logging.INFO)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore" if options.get("quiet") else "always", RunWarning)
        setattr(warnings, "showwarning", _show_warning)
        try:
            if options.get("output"):
                places.append(options.pop("output"))
            elif has_inputs_alone(places, options):
                places.append("")  # OUTPUT, which nothing is written to
            most = 2 if "frames" in options else len(places)
            if not 2 <= len(places) <= most:
                raise Error(f"{len(places)} names of files; give INPUT and OUTPUT", stage="command line")
            _check(places, options)
            if "frames" in options:
                return _run_frames(places, options)
            _run(places, options)
        except Error as error:
            if error.result is not None:
                _tell(f"error: gate failed: {error}")
            else:
                _tell(f"error: {error}")
            return int(error.code)
        except KeyboardInterrupt:
            _tell("error: interrupted")
            return int(ErrorCode.INTERRUPTED)
    return 0


def _check(places: list[str], options: dict[str, Any]) -> None:
    missing = [name for name, value in options.items() if value == ""]
    if missing:
        raise Error(f"--{missing[0].replace('_', '-')} needs a value", stage="command line")
    if "frames" in options and options.get("dry_run"):
        raise Error("--dry-run estimates one frame; leave out --frames and name it", stage="command line")
    if "fill" in options:
        if "frames" in options:
            raise Error("--fill is for one mesh; leave out --frames and name a frame", stage="command line")
        check_target(options["fill"], bool(options.get("force")), [("OUTPUT", place) for place in places[1:][-1:] if place])
    elif "fill_mesher" in options:
        raise Error("--fill-mesher needs --fill FILE", stage="command line")
    if "fill_mesher" in options and options["fill_mesher"] not in MESHERS:
        raise Error(f"--fill-mesher is {options['fill_mesher']}; it must be {' or '.join(MESHERS)}", stage="command line")
    alone = [name for name in OF_FRAMES if name in options and "frames" not in options]
    if alone:
        raise Error(f"--{alone[0].replace('_', '-')} needs --frames", stage="command line")


def _run(places: list[str], options: dict[str, Any]) -> None:
    start = time.perf_counter()
    options.setdefault("progress", "auto")
    source: Union[str, list[str]] = places[0] if len(places) == 2 else places[:-1]
    to_fill, mesher = options.pop("fill", None), options.pop("fill_mesher", "tetgen")
    if options.pop("dry_run", False):
        found = estimate(source, **options)
        _tell("estimate: " + ", ".join(f"{name} {value}" for name, value in found.items()))
        if options.get("stats") == "-":
            print(json.dumps({"schema": 1, "version": VERSION, "estimate": found}, indent=2))
        return
    result: Optional[Result] = None
    try:
        result = remesh(source, output=places[-1], **options)
        if to_fill is not None:
            filled = result.fill(mesher)
            filled.save(to_fill, overwrite=bool(options.get("force")))
            if not options.get("quiet"):
                _tell(f"{to_fill}: {len(filled.vertices)} vertices, {len(filled.tetrahedra)} tetrahedra")
    except Error as error:
        result = error.result
        raise
    finally:
        if result is not None and not options.get("quiet"):
            _tell(f"{places[-1]}: {_summary(result)}, {time.perf_counter() - start:.1f} s")


def _run_frames(places: list[str], options: dict[str, Any]) -> int:
    """The exit status of a sequence that kept going is that of its first bad frame."""
    options.setdefault("progress", "auto")
    is_quiet = bool(options.get("quiet"))
    kept_pct, born, made = [], 0, 0
    with remesh_sequence(places[0], output=places[1], **options) as frames:
        for result in frames:
            made += 1
            if not is_quiet:
                _tell(f"{places[1]}: frame {result.frame}: {_summary(result)}")
            coherence = result.report["coherence"]
            if coherence:
                kept_pct.append(coherence["kept_edges_pct"])
                born += coherence["born"]
    if is_quiet:  # else each was told as a warning
        for error in frames.errors.values():
            _tell(f"error: {error}")
        return _status(frames)
    there = f", {len(frames.found)} there already" if frames.found else ""
    kept = (f"; edges kept {sum(kept_pct) / len(kept_pct):.2f} % on average, {min(kept_pct):.2f} % at worst; "
            f"{born} vert{'ex' if born == 1 else 'ices'} born") if kept_pct else ""
    _tell(f"{made} frame{'' if made == 1 else 's'} made{there}{kept}")
    return _status(frames)


def _status(frames: Frames) -> int:
    return next((int(error.code) for error in frames.errors.values()), 0)


def _summary(result: Result) -> str:
    topology, quality = result.report["topology"], result.report["quality"]
    kind = "closed" if topology["closed"] else "not closed"
    if topology["closed"] and topology["genus"] is not None:  # regions have none together
        kind = f"closed 2-manifold of genus {topology['genus']}"
    features = result.report["features"]
    noise = (f", {features['passed_over']:.3g} of sharp edges taken for noise (--features DEG keeps them)"
             if features["passes_over_much"] else "")
    return (f"{len(result.vertices)} vertices, {len(result.faces)} triangles, {topology['components']} "
            f"component{'' if topology['components'] == 1 else 's'}, {kind}, smallest angle "
            f"{quality['theta_min_deg']:.1f}{noise}")


def _show_warning(message: Any, *_: Any) -> None:
    _tell(f"warning: {message}")


def _tell(text: str) -> None:
    print(f"{PROGRAM}: {text}", file=sys.stderr)
