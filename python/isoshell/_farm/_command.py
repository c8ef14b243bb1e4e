"""The command line of the farm."""

from __future__ import annotations

import argparse
import contextlib
import math
import os
import sys
from typing import Any, Dict, List, Optional, Sequence

from .. import _isoshell
from .._errors import Error
from .._isoshell import ErrorCode
from .._keywords import PLACE
from .._remesh import estimate
from . import _places as places
from ._admission import bytes_of
from ._assets import OF_SEQUENCES, OF_THE_FARM, assets_of
from ._progress import tell

SUFFIXES = (*_isoshell.mesh_formats(), "usda", "usdc", "usdz")


def main(words: Sequence[str]) -> int:
    """Run the farm's command with these words. Returns its exit status."""
    sys.stdout.reconfigure(errors="backslashreplace")  # type: ignore[union-attr] # names need not be text
    arguments = parser().parse_args(words)
    try:
        status: int = arguments.do(arguments, list(words[1:]))
        return status
    except Error as error:
        tell(f"error: {error}")
        return int(error.code)
    except KeyboardInterrupt:
        tell("interrupted")
        return int(ErrorCode.INTERRUPTED)


def parser() -> argparse.ArgumentParser:
    whole = argparse.ArgumentParser(prog="isoshell farm", allow_abbrev=False,
                                    description="Mesh many assets over the workers of a Dask cluster.")
    commands = whole.add_subparsers(required=True, metavar="run|status|report")
    run = commands.add_parser("run", allow_abbrev=False, usage="%(prog)s ASSETS OUT [options]", help="mesh the assets that are not done",
                              description="Mesh the assets that are not done. The options of a mesh are those of the "
                              "command isoshell, the same for all assets unless a table says otherwise.")
    run.add_argument("assets", metavar="ASSETS", help="a folder, a pattern in quotes, or a table (.csv, .jsonl, "
                     ".parquet) with the column path and others that are options; here, or a place that fsspec knows")
    run.add_argument("out", metavar="OUT", help="folder of the meshes, their statistics and the manifest")
    farm = run.add_argument_group("farm")
    farm.add_argument("--scheduler", metavar="S", default="local", help="local, slurm, an address such as "
                      "tcp://host:8786, or the file that dask scheduler --scheduler-file wrote [local]")
    farm.add_argument("--workers", metavar="N", type=_positive, help="local: assets that are meshed side by side [as "
                      "many as there are processors, or 16 for each CUDA device]; slurm: jobs [1]")
    farm.add_argument("--contexts", metavar="N", type=_positive, help="assets that share a process [1, or 16 with a "
                      "CUDA device]")
    farm.add_argument("--time-limit", metavar="S", type=float, default=3600.0, help="seconds that an asset may take, "
                      "0: no limit [3600]")
    farm.add_argument("--memory", metavar="SIZE", help="memory of a worker for the assets that it has at a time, as "
                      "64G [80 %% of what is free, or what Dask gives a worker]")
    farm.add_argument("--asset-memory", metavar="SIZE", help="memory that an asset may take at most [what its estimate "
                      "says, at most that of the worker]")
    farm.add_argument("--dashboard", action="store_true", help="local and slurm: Dask's pages of the run, at a port of "
                      "this machine that all of its users can read; needs bokeh")
    farm.add_argument("--retry-failed", action="store_true", help="also try again what failed before")
    farm.add_argument("--output-format", metavar="F", choices=SUFFIXES, default="ply",
                      help="format of the meshes: " + ", ".join(SUFFIXES) + " [ply]")
    run.set_defaults(do=_run)
    _add_options(run)
    status = commands.add_parser("status", help="say how far a farm is")
    status.add_argument("out", metavar="OUT")
    status.set_defaults(do=_status)
    report = commands.add_parser("report", help="write a page of all assets")
    report.add_argument("out", metavar="OUT")
    report.add_argument("--output", metavar="F.html", help="the page [OUT/report.html]")
    report.add_argument("--parquet", metavar="F.parquet", help="also write the manifest as one table; needs pyarrow")
    report.set_defaults(do=_report)
    return whole


class Lines(argparse.Action):
    """An option that may be given more than once: a line for each time."""

    def __call__(self, parser: argparse.ArgumentParser, given: argparse.Namespace, value: Any,
                 option_string: Any = None) -> None:
        before = getattr(given, self.dest)
        setattr(given, self.dest, value if before is None else f"{before}\n{value}")


def _add_options(run: argparse.ArgumentParser) -> None:
    """Every option of the command that an asset can have."""
    groups: Dict[str, Any] = {}
    for option in _isoshell.option_table():
        name = option.name.replace("-", "_")
        if name in OF_SEQUENCES or name in OF_THE_FARM and name not in PLACE:
            continue
        if option.group not in groups:
            groups[option.group] = run.add_argument_group(option.group.lower())
        text = option.text.replace("%", "%%") + (f" [{option.fallback}]".replace("%", "%%") if option.fallback else "")
        if option.value:
            action = Lines if option.repeats else "store"
            groups[option.group].add_argument(f"--{option.name}", metavar=option.value, help=text, action=action)
        else:
            groups[option.group].add_argument(f"--{option.name}", action="store_true", default=None, help=text)


def _tetrahedron_for(options: dict[str, Any]) -> tuple[list[list[float]], list[list[int]]]:
    """A mesh that options are tried on: 20 times as large as the sizes in world units among them."""
    sizes = []
    for name in ("edge_length", "voxel_size"):
        with contextlib.suppress(KeyError, ValueError):  # what is no number is refused as such
            sizes.append(float(options[name]))
    side = 20 * max(filter(math.isfinite, sizes), default=0.05) or 1.0
    return [[0, 0, 0], [side, 0, 0], [0, side, 0], [0, 0, side]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def _run(arguments: argparse.Namespace, words: List[str]) -> int:
    from ._run import run
    from ._worker import CONTEXTS_OF_DEVICE, devices_of

    given = vars(arguments)
    names = [option.name.replace("-", "_") for option in _isoshell.option_table()]
    options = {name: given[name] for name in names if given.get(name) is not None and name != "output_format"}
    place = {name: options.pop(name) for name in PLACE if name in options}
    if options.get("sizing") and not places.is_remote(options["sizing"]):
        options["sizing"] = os.path.abspath(options["sizing"])
    estimate(_tetrahedron_for(options), **{**options, **place})  # refuses what cannot be, before anything starts
    scheduler = arguments.scheduler
    for option in ("workers", "dashboard"):
        if given[option] and scheduler not in ("local", "slurm"):
            raise Error(f"--{option} is for --scheduler local and slurm; others have the workers and pages that were "
                        "started for them", stage="command line")
    processors = len(os.sched_getaffinity(0))
    devices = len(devices_of(place.get("device")))
    contexts = arguments.contexts or (CONTEXTS_OF_DEVICE if devices else 1)
    slots = arguments.workers or (devices * contexts if devices else processors)
    if scheduler == "local":
        place.setdefault("threads", str(max(1, processors // slots)))
    else:
        place.setdefault("threads", "1")
    out = arguments.out if places.is_remote(arguments.out) else places.local(arguments.out)
    settings = {"scheduler": scheduler, "workers": arguments.workers, "slots": slots, "contexts": arguments.contexts,
                "time_limit": arguments.time_limit or None, "memory": _size("--memory", arguments.memory),
                "asset_memory": _size("--asset-memory", arguments.asset_memory), "place": place,
                "retry_failed": arguments.retry_failed, "dashboard": arguments.dashboard}
    assets = assets_of(arguments.assets, options, f".{arguments.output_format}", out)
    return run(assets, out, settings, words)


def _status(arguments: argparse.Namespace, _: List[str]) -> int:
    from ._status import status

    return status(arguments.out)


def _report(arguments: argparse.Namespace, _: List[str]) -> int:
    from ._page import report

    return report(arguments.out, arguments.output, arguments.parquet)


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not above 0")
    return number


def _size(option: str, text: Optional[str]) -> Optional[int]:
    return bytes_of(option, text) if text else None
