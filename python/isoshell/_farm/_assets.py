"""The assets of a farm: a folder, a pattern or a table, each with its options and the name of its output."""

from __future__ import annotations

import csv
import io
import json
import os
import re
from collections import Counter
from dataclasses import dataclass
from typing import Any, Dict, Iterable, Iterator, List

from .._errors import Error
from .._isoshell import ErrorCode, check_frames, input_formats, path_of_frame, python_formats
from .._keywords import is_flag, kinds
from . import _places as places

READ_BY_PYTHON = [ending for ending, _, reads, _ in python_formats() if reads]
MESHES = tuple(f".{ending}" for ending in (*input_formats(), *READ_BY_PYTHON))
TABLES = (".csv", ".jsonl", ".parquet")
OF_SEQUENCES = ("frames", "velocity", "no_coherence", "keep_going")
OF_THE_FARM = ("stats", "report", "force", "progress", "resume", "dry_run", "output_format", "save_shell",
               "save_voronoi", "save_level_set", "split_regions", "stop_after", "output", "verbose", "quiet", "help", "version", "device",
               "threads", "max_memory")

Options = Dict[str, Any]


@dataclass
class Asset:
    """One input, or the frames of one sequence."""

    path: str
    options: Options
    size: int = 0
    changed: float = 0.0
    output: str = ""  # relative to OUT, with / between folders; names the asset in the manifest


def options_of_table() -> List[str]:
    """What a column of a table may be called, beside path."""
    return sorted((set(kinds()) | set(OF_SEQUENCES)) - set(OF_THE_FARM))


def assets_of(given: str, options: Options, suffix: str, out: str) -> List[Asset]:
    """The assets that ASSETS means, largest first, with the names of their outputs. What lies below OUT is none.

    Raises:
        Error: of code UNREADABLE_INPUT where there is none or the place cannot be read; of code USAGE for a table that
            cannot be.
    """
    place = given if places.is_remote(given) else places.local(given)
    own = out if places.is_remote(out) else places.local(out)
    try:
        if place.lower().endswith(TABLES) and not places.is_folder(place):
            root, assets = _folder_of(place), list(_of_table(place, options))
        elif places.is_folder(place):
            root, assets = place, [Asset(places.join(place, name), dict(options), file.size, file.changed)
                                   for name, file in places.files_below(place) if _is_input(name)]
        else:
            root = _folder_of(re.split(r"[*?\[]", place)[0])
            assets = [Asset(name, dict(options), file.size, file.changed)
                      for name, file in places.matches_of(place).items() if name == place or _is_input(name)]
    except OSError as error:
        raise Error(f"{error.filename or given}: {error.strerror or error}", ErrorCode.UNREADABLE_INPUT,
                    "assets") from error
    assets = [asset for asset in assets if not asset.path.startswith(own.rstrip("/") + "/")]
    if not assets:
        raise Error(f"{given}: no asset there; give a folder or a pattern of files that the command reads "
                    f"({' '.join(MESHES)}), or a table ({' '.join(TABLES)})", ErrorCode.UNREADABLE_INPUT, "assets")
    _name_outputs(assets, root, suffix)
    assets.sort(key=lambda asset: (-asset.size, asset.output))
    return assets


def file_of(path: str) -> str:
    """The file of a path that may name a grid or a prim in it."""
    named = re.match(r"(.+\.(?:vdb|nvdb|usd[acz]?)):.*$", path, re.IGNORECASE)
    return named[1] if named else path


def files_of(path: str, options: Options) -> Iterator[str]:
    """The file of an asset, or those of its frames, in order."""
    file, frames = file_of(path), options.get("frames")
    if not frames:
        yield file
        return
    for number in check_frames([], "", "", str(frames), True, False):
        yield path_of_frame(file, number)


def _is_input(name: str) -> bool:
    return name.lower().endswith(MESHES) and not os.path.basename(name).startswith(".")


def _folder_of(place: str) -> str:
    return place.rpartition("/")[0] or "/"


def _of_table(place: str, options: Options) -> Iterator[Asset]:
    for number, row in enumerate(_rows_of(place), 1):
        try:
            asset = _asset_of_row(row, _folder_of(place), options)
            found = [places.file_at(file) for file in files_of(asset.path, asset.options)]
            asset.size, asset.changed = sum(file.size for file in found), max(file.changed for file in found)
        except OSError:
            pass  # its row in the manifest will say so
        except Error as error:
            raise Error(f"{place}: row {number}: {error}", stage="assets") from error
        yield asset


def _asset_of_row(row: Dict[str, Any], folder: str, options: Options) -> Asset:
    allowed = options_of_table()
    given = {str(name).strip().replace("-", "_"): value for name, value in row.items()}
    path = given.pop("path", None)
    if not path or not isinstance(path, str):
        raise Error("it has no path; a table has the column path, and others are options", stage="assets")
    if "\0" in path:
        raise Error(f"the path {path!r} has a character NUL, which no name of a file has", stage="assets")
    for name in given:
        if name not in allowed:
            raise Error(f"the column {name} is no option of an asset; there are {', '.join(allowed)}", stage="assets")
    own = {name: _value_of(name, value) for name, value in given.items()}
    merged = {**options, **{name: value for name, value in own.items() if value is not None}}
    if not places.is_remote(path):
        path = path if os.path.isabs(path) else places.join(folder, path)
    return Asset(path, merged)


def _rows_of(place: str) -> Iterable[Dict[str, Any]]:
    content = places.read_bytes(place)
    kind = place.lower().rpartition(".")[2]
    if kind == "parquet":
        parquet = places.package("pyarrow.parquet")
        try:
            return list(parquet.read_table(io.BytesIO(content)).to_pylist())
        except ValueError as error:  # what pyarrow raises of a damaged file is one
            raise Error(f"{place}: no table of Parquet: {error}", stage="assets") from error
    text = _text_of(place, content)
    return _rows_of_csv(place, text) if kind == "csv" else _rows_of_lines(place, text)


def _text_of(place: str, content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[:error.start].count(b"\n") + 1  # a mark at the begin of the file has no line break
        raise Error(f"{place}: line {line} is not UTF-8: it has the byte 0x{error.object[error.start]:02x}; save the "
                    "table as UTF-8, or give a folder or a pattern where names of files are not UTF-8",
                    stage="assets") from error


def _rows_of_csv(place: str, text: str) -> List[Dict[str, Any]]:
    reader = csv.DictReader(io.StringIO(text, newline=""), strict=True)
    rows = []
    try:
        for row in reader:
            if None in row:
                raise Error(f"{place}: line {reader.reader.line_num} has more cells than the first line has names",
                            stage="assets")
            rows.append(row)
    except csv.Error as error:
        raise Error(f"{place}: line {reader.reader.line_num}: {error}", stage="assets") from error
    return rows


def _rows_of_lines(place: str, text: str) -> List[Dict[str, Any]]:
    rows = []
    for number, line in enumerate(text.split("\n"), 1):
        if line.strip():
            try:
                row = json.loads(line)
            except (ValueError, RecursionError) as error:
                raise Error(f"{place}: line {number} is no JSON: {error}", stage="assets") from error
            if not isinstance(row, dict):
                raise Error(f"{place}: line {number} is no object of JSON", stage="assets")
            rows.append(row)
    return rows


def _value_of(name: str, value: Any) -> Any:
    """A flag as True or None; anything else as it is, and None where nothing is given."""
    if value is None or value == "":
        return None
    if is_flag(name):
        text = str(value).strip().lower()
        if text not in ("true", "false", "yes", "no", "1", "0"):
            raise Error(f"{name} is {value!r}; it must be true or false", stage="assets")
        return True if text in ("true", "yes", "1") else None
    if isinstance(value, (list, tuple)):
        return ",".join(map(str, value))
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)


def _name_outputs(assets: List[Asset], root: str, suffix: str) -> None:
    """Relative paths with the suffix of the output: a.ply and a.obj become a.ply.ply and a.obj.ply, and an asset that
    is there several times a-2, a-3 ..., in the order of the table."""
    assets.sort(key=lambda asset: asset.path)
    names = [_relative(asset.path, root) for asset in assets]
    stems = [_stem(name) for name in names]
    several = Counter(stem.lower() for stem in stems)
    same = Counter(names)
    taken = set()
    for asset, name, stem in zip(assets, names, stems):
        wished = stem if several[stem.lower()] == same[name] else name
        output, again = f"{wished}{suffix}", 1
        while output.lower() in taken:
            again += 1
            output = f"{wished}-{again}{suffix}"
        taken.add(output.lower())
        asset.output = output


def _relative(path: str, root: str) -> str:
    """Without what no name of a file should have; what is not below the root keeps its whole path."""
    inside = path.startswith(root.rstrip("/") + "/")
    name = path[len(root.rstrip("/")) + 1:] if inside else path.split("://")[-1].lstrip("/")
    return re.sub(r"[:\[\]]+", "_", os.path.normpath(name)).replace("../", "")


def _stem(name: str) -> str:
    ending = max((ending for ending in MESHES if name.lower().endswith(ending)), key=len, default="")
    return name[:len(name) - len(ending)]
