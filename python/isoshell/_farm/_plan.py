"""What is left to do of a farm."""

from __future__ import annotations

import os
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple

import isoshell

from . import _places as places
from ._assets import Asset, files_of
from ._manifest import Row

Sizes = Dict[str, int]


class Plan(NamedTuple):
    """The assets of a run."""

    wanted: List[Tuple[Asset, Optional[Row]]]  # with the row of an output that is done if the input is the same
    done: int    # have the result that they would get
    failed: int  # failed before in the same way


def plan_of(assets: Iterable[Asset], rows: Dict[str, Row], out: str, retry_failed: bool) -> Plan:
    """Done is what has the same input, options and version, and whose output is there."""
    sizes: Sizes = {name: file.size for name, file in places.files_below(out)} if rows else {}
    wanted: List[Tuple[Asset, Optional[Row]]] = []
    done = failed = 0
    for asset in assets:
        row = rows.get(asset.output)
        if row is None or row["options"] != asset.options or row["version"] != isoshell.__version__:
            wanted.append((asset, None))
        elif row["state"] == "done":
            if not is_there(row, sizes):
                wanted.append((asset, None))
            elif is_same_input(asset, row):
                done += 1
            else:
                wanted.append((asset, row))
        elif row.get("transient") or retry_failed or not is_same_input(asset, row):
            wanted.append((asset, None))
        else:
            failed += 1
    return Plan(wanted, done, failed)


def is_same_input(asset: Asset, row: Row) -> bool:
    """By size and time; another time makes the worker compare what the file holds."""
    return bool(row["asset"] == asset.path and row["input_size"] == asset.size
                and row["input_changed"] == asset.changed)


def is_there(row: Row, sizes: Sizes) -> bool:
    """Whether the output is, and as large as it was."""
    folder, name = os.path.split(row["output"])
    there = [sizes.get(os.path.join(folder, file)) for file in files_of(name, row["options"])]
    statistics = os.path.splitext(row["output"])[0] + ".json"
    is_told = bool(row["options"].get("frames")) or statistics in sizes
    return is_told and None not in there and sum(size or 0 for size in there) == row["output_size"]


def job_of(asset: Asset, known: Optional[Row], common: Dict[str, Any]) -> Dict[str, Any]:
    """What a worker is told of an asset."""
    return {**common, "path": asset.path, "options": asset.options, "output": asset.output, "input_size": asset.size,
            "input_changed": asset.changed, "known_sha256": known and known.get("input_sha256"),
            "known": known and {name: known[name] for name in KEPT if name in known}}


KEPT = ("digest", "output_sha256", "output_size", "gates", "peak_memory", "device_memory", "device", "vertices",
        "triangles", "min_angle", "quality", "deviation_pct", "frames")
