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
from .._isoshell import ErrorCode, input_formats
from .._keywords import is_flag, kinds
from . import _places as places

MESHES = (*(f".{name}" for name in input_formats()), ".usd", ".usda", ".usdc", ".usdz")
TABLES = (".csv", ".jsonl", ".parquet")
OF_SEQUENCES = ("frames", "velocity", "no_coherence", "keep_going")
OF_THE_FARM = ("stats", "report", "force", "progress", "resume", "dry_run", "output_format", "save_shell",
               "save_voronoi", "split_regions", "stop_after", "verbose", "quiet", "help", "version", "device",
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


def files_of(path: str, options: Options) -> List[str]:
    """The file of an asset, or those of its frames, in order."""
    file = file_of(path)
    frames = options.get("frames")
    if not frames:
        return [file]
    parsed = re.fullmatch(r"(\d+)(?:-(\d+))?(?:x(\d+))?", str(frames))
    if not parsed:
        raise Error(f"frames is {frames!r}; it must be A-B or A-BxSTEP", stage="assets")
    first, last, step = int(parsed[1]), int(parsed[2] or parsed[1]), int(parsed[3] or 1)
    if step < 1 or last < first:
        raise Error(f"frames is {frames!r}; A must not be above B, and STEP at least 1", stage="assets")
    return [path_of_frame(file, number) for number in range(first, last + 1, step)]


def path_of_frame(pattern: str, number: int) -> str:
    """As the command does it: #### and %04d are where the number is."""

    def written(place: re.Match[str]) -> str:
        digits = len(place[0]) if place[0][0] == "#" else int(place[1] or 1)
        return f"{number:0{digits}d}"

    return re.sub(r"#+|%(\d*)d", written, pattern)


def _is_input(name: str) -> bool:
    return name.lower().endswith(MESHES) and not os.path.basename(name).startswith(".")


def _folder_of(place: str) -> str:
    return place.rpartition("/")[0] or "/"


def _of_table(place: str, options: Options) -> Iterator[Asset]:
    allowed = options_of_table()
    for number, row in enumerate(_rows_of(place), 1):
        given = {str(name).strip().replace("-", "_"): value for name, value in row.items()}
        path = given.pop("path", None)
        if not path or not isinstance(path, str):
            raise Error(f"{place}: row {number} has no path; a table has the column path, and others are options",
                        stage="assets")
        for name in given:
            if name not in allowed:
                raise Error(f"{place}: the column {name} is no option of an asset; there are {', '.join(allowed)}",
                            stage="assets")
        own = {name: _value_of(place, number, name, value) for name, value in given.items()}
        merged = {**options, **{name: value for name, value in own.items() if value is not None}}
        if not places.is_remote(path):
            path = path if os.path.isabs(path) else places.join(_folder_of(place), path)
        asset = Asset(path, merged)
        try:
            found = [places.file_at(file) for file in files_of(path, merged)]
            asset.size, asset.changed = sum(file.size for file in found), max(file.changed for file in found)
        except OSError:
            pass  # its row in the manifest will say so
        yield asset


def _rows_of(place: str) -> Iterable[Dict[str, Any]]:
    content = places.read_bytes(place)
    kind = place.lower().rpartition(".")[2]
    if kind == "parquet":
        table = places.package("pyarrow.parquet").read_table(io.BytesIO(content))
        return list(table.to_pylist())
    text = content.decode("utf-8-sig")
    if kind == "csv":
        return list(csv.DictReader(io.StringIO(text, newline="")))
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        if line.strip():
            try:
                row = json.loads(line)
            except ValueError as error:
                raise Error(f"{place}: line {number} is no JSON: {error}", stage="assets") from error
            if not isinstance(row, dict):
                raise Error(f"{place}: line {number} is no object of JSON", stage="assets")
            rows.append(row)
    return rows


def _value_of(place: str, number: int, name: str, value: Any) -> Any:
    """A flag as True or None; anything else as it is, and None where nothing is given."""
    if value is None or value == "":
        return None
    if is_flag(name):
        text = str(value).strip().lower()
        if text not in ("true", "false", "yes", "no", "1", "0"):
            raise Error(f"{place}: row {number}: {name} is {value!r}; it must be true or false", stage="assets")
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
    stem, suffix = os.path.splitext(name)
    return stem if suffix.lower() in MESHES else name
