"""isoshell farm status: how far a farm is."""

from __future__ import annotations

import time
from collections import Counter
from typing import Dict, List, NamedTuple, Optional

from .._errors import Error
from .._isoshell import ErrorCode
from . import _manifest as manifest
from . import _places as places
from ._admission import text_of
from ._progress import duration, tell

MOST = 5  # of a list


def tell_damaged(found: manifest.Manifest, what_next: str) -> None:
    """Which rows of the manifest mean nothing, and why."""
    for text in found.damaged[:MOST]:
        tell(f"warning: {text}")
    if found.damaged:
        tell(f"warning: {len(found.damaged)} damaged rows are passed over; {what_next}")


class Counts(NamedTuple):
    """Of the last run, which may still be going on."""

    assets: int
    done: int
    failed: int
    remaining: int
    a_second: Optional[float]


def read_farm(out: str) -> manifest.Manifest:
    """The manifest of a farm. Raises Error where there is none."""
    try:
        found = manifest.read(out if places.is_remote(out) else places.local(out))
    except OSError as error:
        raise Error(f"{error.filename or out}: {error.strerror or error}", ErrorCode.UNREADABLE_INPUT,
                    "farm") from error
    tell_damaged(found, "isoshell farm run makes again what they were of")
    if not found.runs:
        raise Error(f"{out}: no manifest there; give the OUT of isoshell farm run", ErrorCode.UNREADABLE_INPUT, "farm")
    return found


def counts_of(found: manifest.Manifest) -> Counts:
    last = found.runs[-1]
    rows = [row for row in found.rows.values() if row["run"] == last["began"]]
    failed = sum(row["state"] == "failed" for row in rows)
    seconds = max((float(row["time"]) for row in rows), default=0.0) - float(last["time"])
    return Counts(last["assets"], last["done"] + len(rows) - failed, last["failed"] + failed,
                  last["assets"] - last["done"] - last["failed"] - len(rows),
                  len(rows) / seconds if rows and seconds > 0 else None)


def reasons_of(rows: Dict[str, manifest.Row]) -> Dict[str, List[manifest.Row]]:
    """Rows of what failed, by error code, the commonest first."""
    failed = [row for row in rows.values() if row["state"] == "failed"]
    common = Counter(row["code"] for row in failed).most_common()
    return {code: sorted((row for row in failed if row["code"] == code), key=lambda row: str(row["output"]))
            for code, _ in common}


def status(out: str) -> int:
    """Prints it. Returns the exit status."""
    found = read_farm(out)
    counts = counts_of(found)
    print(f"{counts.assets} assets: {counts.done} done, {counts.failed} failed, {counts.remaining} remaining")
    if counts.a_second:
        left = f", about {duration(counts.remaining / counts.a_second)} left" if counts.remaining else ""
        ago = time.time() - max(float(row["time"]) for row in found.rows.values())
        print(f"{counts.a_second:.2g} assets a second in the last run{left}; the last row is {duration(max(ago, 0))} "
              "old")
    slow = sorted(found.rows.values(), key=lambda row: -float(row["seconds"]))[:MOST]
    if slow:
        print("slowest:")
    for row in slow:
        print(f"  {row['seconds']:8.1f} s  {text_of(row.get('peak_memory')):>7}  {row['asset']}")
    for code, rows in reasons_of(found.rows).items():
        print(f"{code}: {len(rows)}")
        for row in rows[:MOST]:
            print(f"  {row['asset']}: {row['message']}")
        if len(rows) > MOST:
            print(f"  and {len(rows) - MOST} more")
    if counts.remaining:
        print(f"to go on: {found.runs[-1]['command']}")
    return 0
