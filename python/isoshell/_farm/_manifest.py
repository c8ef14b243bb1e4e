"""The manifest: what became of every asset.

Rows are lines of JSON in files that each have one writer; the last row of an asset counts. A line that was torn by the
end of its writer is passed over, and so are damaged ones, which are named.
"""

from __future__ import annotations

import json
import os
import socket
import tempfile
import time
import uuid
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from .._isoshell import VERSION, put_in_place
from .._paths import writing
from . import _places as places
from ._rows import Damaged, line_of, row_of
from ._rows import Row as Row  # others have it from here

FOLDER = "manifest"
SECONDS_APART = 1e-3
ROWS_A_FILE = 256  # in object storage, where a file is put whole after each row


class Manifest(NamedTuple):
    """What the manifest says."""

    rows: Dict[str, Row]  # the last of each asset, by its output
    runs: List[Row]       # what `farm run` said when it began, in order of time
    damaged: List[str]    # file, line and what is wrong with it

    @property
    def newest(self) -> float:
        """When the last row was written."""
        return max((float(row["time"]) for row in [*self.rows.values(), *self.runs]), default=0.0)


def row_of_job(job: Dict[str, Any], worker: str) -> Row:
    """What is known of an asset before anything is done with it."""
    return {"output": job["output"], "asset": job["path"], "options": job["options"], "version": VERSION,
            "run": job["run"], "input_size": job["input_size"], "input_changed": job["input_changed"], "gates": {},
            "worker": worker, "attempts": 1}


class Writer:
    """Appends rows to a file of its own. A row is on the disk when append() returns. Its time is never before that of
    the rows that were there, by whatever clock they have theirs."""

    def __init__(self, out: str, newest: float) -> None:
        self._folder = places.join(out, FOLDER)
        self._earliest = newest + SECONDS_APART
        self._handle: Optional[int] = None
        self._name = ""
        self._lines: List[bytes] = []

    def append(self, row: Row) -> None:
        """Raises OSError where the row cannot be kept; nothing of it is left then."""
        row["time"] = max(time.time(), self._earliest)
        line = line_of(row)
        if places.is_remote(self._folder):
            self._put(line)
        else:
            self._write(line)

    def close(self) -> None:
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None

    def _write(self, line: bytes) -> None:
        if self._handle is None:
            os.makedirs(self._folder, exist_ok=True)
            path = places.join(self._folder, _new_name())
            self._handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        begin = os.fstat(self._handle).st_size
        try:
            written = os.write(self._handle, line)
            while written < len(line):
                written += os.write(self._handle, line[written:])
            os.fsync(self._handle)
        except OSError:
            os.ftruncate(self._handle, begin)
            raise

    def _put(self, line: bytes) -> None:
        if not self._name or len(self._lines) == ROWS_A_FILE:
            self._name, self._lines = _new_name(), []
        system, path = places.file_system(places.join(self._folder, self._name))
        system.makedirs(system._parent(path), exist_ok=True)
        system.pipe_file(path, b"".join([*self._lines, line]))
        self._lines.append(line)


def read(out: str) -> Manifest:
    """Everything that was ever written below OUT; empty where nothing was."""
    rows: Dict[str, Row] = {}
    runs: List[Row] = []
    damaged: List[str] = []
    folder = places.join(out, FOLDER)
    for name in sorted(name for name, _ in places.files_below(folder) if name.endswith(".jsonl")):
        *lines, _ = places.read_bytes(places.join(folder, name)).split(b"\n")
        for number, line in enumerate(lines, 1):
            try:
                row = row_of(line)
            except Damaged as error:
                damaged.append(f"{FOLDER}/{name}, line {number}: {error}")
                continue
            if "began" in row:
                runs.append(row)
            elif row["output"] not in rows or rows[row["output"]]["time"] <= row["time"]:
                rows[row["output"]] = row
    runs.sort(key=lambda run: float(run["time"]))
    return Manifest(rows, runs, damaged)


def parquet_library() -> Tuple[Any, Any]:
    """pyarrow, and its module of Parquet.

    Raises:
        Error: of code USAGE without it, saying what to install.
    """
    return places.package("pyarrow"), places.package("pyarrow.parquet")


def compact(manifest: Manifest, path: str) -> None:
    """Write the rows as one table of Parquet. Needs pyarrow.

    Raises:
        Error: of code UNWRITABLE_OUTPUT.
    """
    pyarrow, parquet = parquet_library()
    flat = [{**_as_text(row), "options": json.dumps(row["options"], sort_keys=True), "gates": json.dumps(row["gates"])}
            for _, row in sorted(manifest.rows.items())]
    names = list(dict.fromkeys(name for row in flat for name in row))
    with writing(path), tempfile.TemporaryDirectory(prefix=".isoshell-", dir=os.path.dirname(path) or ".") as work:
        part = os.path.join(work, "table.parquet")
        parquet.write_table(pyarrow.table({name: [row.get(name) for row in flat] for name in names}), part)
        put_in_place(part, path, True)


def _as_text(row: Row) -> Row:
    """What Parquet takes: names that are not UTF-8 with their bytes escaped."""
    return {name: value.encode("utf-8", "backslashreplace").decode() if isinstance(value, str) else value
            for name, value in row.items()}


def _new_name() -> str:
    return f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}.jsonl"
