"""What OpenVDB files say of their grids before the voxels: names, types, classes and where they lie."""

from __future__ import annotations

import os
import struct
from dataclasses import dataclass
from typing import Any, Iterator

from ._errors import Error
from ._isoshell import ErrorCode

MAGIC = 0x56444220
OLDEST = 222  # of the format: since then grids say how they are compressed
LONGEST = 1 << 20  # bytes of a text; what claims more is no header
TABLES = ("surface_points", "surface_triangles", "surface_source_face", "seed_points", "seed_normals", "seed_homes")
MATRIX_MAPS = ("AffineMap", "UnitaryMap")

Box = tuple[tuple[float, float, float], tuple[float, float, float]]


@dataclass
class Grid:
    """A grid of a file.

    Attributes:
        name, type: as the file has them, such as Tree_float_5_4_3.
        metadata: what the file says of it, of the types text and three whole numbers.
        rows: (4, 3) numbers that turn an index, as a row behind which stands 1, into a place in the world.
    """

    name: str
    type: str
    metadata: dict[str, Any]
    rows: list[list[float]]

    @property
    def grid_class(self) -> str:
        """What its values are: "level set", "fog volume" and so on; "unknown" when the file does not say it."""
        return str(self.metadata.get("class", "unknown"))

    def box(self) -> Box | None:
        """The world's box of its active voxels to their far sides; None when the file does not say it."""
        low, high = self.metadata.get("file_bbox_min"), self.metadata.get("file_bbox_max")
        if low is None or high is None or any(a > b for a, b in zip(low, high)):
            return None
        ends = [(a - 0.5, b + 0.5) for a, b in zip(low, high)]
        corners = [[sum(p * self.rows[i][axis] for i, p in enumerate(corner)) + self.rows[3][axis] for axis in range(3)]
                   for corner in ((x, y, z) for x in ends[0] for y in ends[1] for z in ends[2])]
        x, y, z = zip(*corners)
        return (min(x), min(y), min(z)), (max(x), max(y), max(z))


class _Reader:
    """Takes values from a file, and refuses what is not there."""

    def __init__(self, path: str) -> None:
        self.path = path
        try:
            self.file = open(path, "rb")
        except OSError as error:
            raise self.refused(os.strerror(error.errno or 0)) from error

    def refused(self, what: str) -> Error:
        return Error(f"{self.path}: {what}", ErrorCode.UNREADABLE_INPUT, "read")

    def take(self, layout: str) -> tuple[Any, ...]:
        return struct.unpack("<" + layout, self.bytes(struct.calcsize("<" + layout)))

    def bytes(self, count: int) -> bytes:
        if count > LONGEST:
            raise self.refused(f"a text of {count} bytes in the header; the file is damaged")
        data = self.file.read(count)
        if len(data) < count:
            raise self.refused("ends within its header")
        return data

    def text(self) -> str:
        (length,) = self.take("I")
        return self.bytes(length).decode("utf-8", "replace")

    def metadata(self) -> dict[str, Any]:
        (count,) = self.take("I")
        known: dict[str, Any] = {}
        for _ in range(count):
            name, kind = self.text(), self.text()
            (length,) = self.take("I")
            if kind not in ("string", "vec3i") or (kind == "vec3i" and length != 12):
                self.file.seek(length, os.SEEK_CUR)
                continue
            data = self.bytes(length)
            known[name] = data.decode("utf-8", "replace") if kind == "string" else struct.unpack("<3i", data)
        return known

    def rows(self, map_type: str) -> list[list[float]]:
        if map_type in MATRIX_MAPS:
            m = self.take("16d")
            return [list(m[4 * i:4 * i + 3]) for i in range(4)]
        moved: tuple[Any, ...] = (0.0, 0.0, 0.0)
        scale: tuple[Any, ...] = (1.0, 1.0, 1.0)
        if "Translat" in map_type:
            moved = self.take("3d")
        if "Scale" in map_type:
            scale = self.take("3d")
        if map_type not in ("TranslationMap", "ScaleMap", "UniformScaleMap", "ScaleTranslateMap",
                            "UniformScaleTranslateMap"):
            raise self.refused(f"a grid has a {map_type}, whose place is not known")
        return [[scale[0], 0, 0], [0, scale[1], 0], [0, 0, scale[2]], list(moved)]


def grids_of(path: str) -> list[Grid]:
    """The grids of an OpenVDB file, without the tables of stage files.

    Raises:
        Error: of code UNREADABLE_INPUT for what is no such file.
    """
    reader = _Reader(path)
    with reader.file:
        return [grid for grid in _all_grids(reader) if grid.name not in TABLES]


def _all_grids(reader: _Reader) -> Iterator[Grid]:
    (magic,) = reader.take("q")
    if magic != MAGIC:
        raise reader.refused("is no OpenVDB file")
    version, _, _ = reader.take("3I")
    (has_offsets,) = reader.take("?")
    if version < OLDEST or not has_offsets:
        raise reader.refused(f"has the format {version} of OpenVDB; save it with a newer version of it")
    reader.bytes(36)  # its identifier
    reader.metadata()
    (count,) = reader.take("I")
    for _ in range(count):
        name, kind, parent = reader.text(), reader.text(), reader.text()
        start, _, end = reader.take("3q")
        if not parent:  # an instance shares the voxels of another
            reader.file.seek(start)
            reader.take("I")  # its compression
            metadata = reader.metadata()
            yield Grid(name.split("\x1e")[0], kind.removesuffix("_HalfFloat"), metadata, reader.rows(reader.text()))
        if not start <= end <= os.path.getsize(reader.path):
            raise reader.refused(f"its grid {name} ends behind the file")
        reader.file.seek(end)
