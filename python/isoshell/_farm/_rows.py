"""Rows of the manifest as lines: each with a checksum, and none taken that is not as it was written."""

from __future__ import annotations

import json
import math
import re
import time
import zlib
from typing import Any, Dict

Row = Dict[str, Any]
CHECKED = re.compile(rb'(\{.*),"crc32":"([0-9a-f]{8})"\}', re.DOTALL)
SECONDS_AHEAD = 86400.0  # that a clock of another machine may be; what is later tells nothing of before and after

NUMBER = (int, float)
ALWAYS = {"version": str, "time": NUMBER}
OF_RUNS = {"began": str, "assets": int, "done": int, "failed": int, "command": str}
OF_ASSETS = {"output": str, "asset": str, "options": dict, "run": str, "state": str, "input_size": int,
             "input_changed": NUMBER, "gates": dict, "seconds": NUMBER, "attempts": int}
OF_STATES: Dict[Any, Dict[str, Any]] = {"done": {"output_sha256": str, "output_size": int},
                                        "failed": {"code": str, "message": str}}
WHERE_KNOWN = {"input_sha256": str, "digest": str, "rejected": str, "frames": int, "vertices": int, "triangles": int,
               "peak_memory": int, "device_memory": int, "min_angle": NUMBER, "quality": NUMBER,
               "deviation_pct": NUMBER}


class Damaged(ValueError):
    """A line that is no row; says why."""


def line_of(row: Row) -> bytes:
    """Bytes of a name that are not UTF-8, which Python keeps as lone surrogates, are escaped as JSON does it."""
    text = json.dumps(row, ensure_ascii=False, separators=(",", ":")).encode("utf-8", "backslashreplace")
    return b'%b,"crc32":"%08x"}\n' % (text[:-1], zlib.crc32(text))


def row_of(line: bytes) -> Row:
    """Of a line without its end. Raises Damaged."""
    checked = CHECKED.fullmatch(line)
    if not checked or zlib.crc32(checked[1] + b"}") != int(checked[2], 16):
        raise Damaged("its checksum is another")
    try:
        row = json.loads(checked[1] + b"}")
    except (ValueError, RecursionError) as error:
        raise Damaged(f"it is no JSON: {error}") from error
    kind = OF_RUNS if "began" in row else {**OF_ASSETS, **OF_STATES.get(str(row.get("state")), {"state": None})}
    for name, wanted in {**ALWAYS, **kind}.items():
        if not is_of(row.get(name), wanted):
            raise Damaged(f"{name} is {row.get(name)!r:.60}")
    for name, wanted in WHERE_KNOWN.items():
        if row.get(name) is not None and not is_of(row[name], wanted):
            raise Damaged(f"{name} is {row[name]!r:.60}")
    if row["time"] > time.time() + SECONDS_AHEAD:
        raise Damaged(f"its time, {row['time']:.0f} s since 1970, is more than a day ahead of now")
    return dict(row)


def is_of(value: Any, wanted: Any) -> bool:
    if wanted is None or not isinstance(value, wanted) or isinstance(value, bool):
        return False
    return not isinstance(value, float) or math.isfinite(value)
