"""What a mesh of another package has beside its positions, as attributes of an isoshell.Mesh."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence

from .. import _isoshell
from .._arrays import array_of, nan_where_masked
from .._errors import Error
from .._labels import joined_regions
from .._polygons import split_polygons
from .._inputs import Mesh

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]

# By their names in lower case, without anything but letters.
COLORS = ("color", "colors", "rgb", "rgba", "vertexcolor", "vertexcolors", "facecolor", "facecolors")
UVS = ("uv", "uvs", "st", "tcoords", "texcoord", "texcoords", "texturecoordinate", "texturecoordinates")
NORMALS = ("normal", "normals", "vertexnormal", "vertexnormals")
REGIONS = ("region_inside", "region_outside")
OF_ITSELF = ("gap", "vtkOriginalPointIds", "vtkOriginalCellIds", "gmsh:dim_tags", "gmsh:geometrical")  # says nothing of another mesh
MOST_COLUMNS = 16


class Taker:
    """Makes a Mesh. Faces are of any number of corners, and attributes are of vertices, of faces or of their corners.

    Args:
        name: what messages call the mesh.
        vertices: (K, 3).
        faces: (M, 3), or the corners of all faces in a row.
        sizes: of each face its number of corners, where these are in a row.
    """

    def __init__(self, name: str, vertices: Any, faces: Any, sizes: Any = None) -> None:
        import numpy as np

        self._points = np.asarray(array_of("vertices", vertices), np.float64)
        if self._points.ndim != 2 or self._points.shape[1] not in (2, 3):
            raise Error(f"{name}: its points must be rows of three numbers, and have the shape {self._points.shape}")
        if self._points.shape[1] == 2:
            self._points = np.column_stack([self._points, np.zeros(len(self._points))])
        corners = array_of("faces", faces)
        sizes = np.full(len(corners), 3, np.int64) if sizes is None else np.asarray(sizes, np.int64)
        corners = corners.reshape(-1)
        wrong = (corners < 0) | (corners >= len(self._points))
        if np.any(wrong):
            at = int(np.argmax(wrong))
            raise Error(f"{name}: a face has vertex {corners[at]}; there are {len(self._points)} vertices",
                        _isoshell.ErrorCode.UNREADABLE_INPUT, "read")
        self._face_of, self._corner_of = split_polygons(name, self._points, sizes, corners, np.ones(len(sizes), bool))
        self._sizes, self._corners = sizes, corners
        self.mesh = Mesh(self._points, corners[self._corner_of])
        self.mesh.name = name

    def add(self, name: str, domain: str, values: Any, labels: Sequence[str] = ()) -> None:
        """An attribute of "vertex", "face" or "corner"; what is none is noted as dropped."""
        import numpy as np

        name = str(name).replace("\n", " ")
        if name in OF_ITSELF:
            return self.drop(name, "it is of the mesh that it was made for")
        array = nan_where_masked(f"the attribute '{name}'", values) if np.ma.is_masked(values) else np.asarray(values)
        if array.dtype.kind in "USO":
            array, labels = _numbered(array)
            if domain != "face":
                return self.drop(name, "texts are kept where they are of faces")
        if domain == "face" and array.ndim == 3 and array.shape[1] == 3 and (self._sizes == 3).all():
            domain, array = "corner", array.reshape(-1, array.shape[2])
        if array.dtype.kind not in "biuf":
            return self.drop(name, f"values of the type {array.dtype} are not kept")
        count = {"vertex": len(self._points), "face": len(self._sizes), "corner": len(self._corners)}[domain]
        if array.ndim == 0 or len(array) != count:
            return self.drop(name, f"it has the shape {array.shape}, and there are {count}, one for each {domain}")
        self._add_rows(name, domain, _storable(array.reshape(count, -1)), list(labels))

    def drop(self, name: str, reason: str) -> None:
        """Notes what is not kept, and why: report["attributes"] says so."""
        self.mesh.dropped.append((str(name), reason))

    def add_names(self, notes: Mapping[str, Any]) -> None:
        """Names of regions and of labels, as Given.notes has them."""
        if "region_background" in notes and self.mesh.regions is not None:
            self.mesh.regions["background"] = int(_item(notes["region_background"]))
            self.mesh.regions["names"] = dict(zip(map(int, notes.get("region_numbers", [])),
                                                  map(str, notes.get("region_names", []))))
        for attribute in self.mesh.of_faces:
            if f"{attribute}_names" in notes:
                self.mesh.labels[attribute] = [str(name) for name in notes[f"{attribute}_names"]]

    def _add_rows(self, name: str, domain: str, rows: Array, labels: list[str]) -> None:
        width, bare = rows.shape[1], re.sub("[^a-z]", "", name.lower())
        if width in (3, 4) and bare in COLORS and domain != "corner":
            return self._put("color", domain, _as_color(rows))
        if width == 3 and bare in NORMALS:
            return self._put("normal", "corner", self._by_corner(domain, rows))
        if bare in UVS and (width == 2 or (width == 3 and not rows[:, 2].any())):  # some formats have no pairs
            number = re.search(r"[1-9]\d*$", name)  # TEXCOORD_0 is the first, as uv is
            return self._put("uv" + (number.group() if number else ""), "corner", self._by_corner(domain, rows[:, :2]))
        if domain == "corner":
            return self.drop(name, "of corners of faces only texture coordinates and normals are kept")
        if re.fullmatch(r"uv\d*|normal|color|texnumber", name):
            name += "_"
        if width > MOST_COLUMNS:
            return self.drop(name, f"it has {width} numbers each, and at most {MOST_COLUMNS} are kept")
        if width == 1:
            if name in REGIONS and domain == "face" and rows.dtype.kind in "iuf":
                return self._add_region(REGIONS.index(name), rows[:, 0])
            return self._put(name, domain, rows[:, 0], labels)
        for i in range(width):
            self._put(f"{name}.{i}", domain, rows[:, i])

    def _put(self, name: str, domain: str, rows: Array, labels: Sequence[str] = ()) -> None:
        of = {"vertex": self.mesh.of_vertices, "face": self.mesh.of_faces, "corner": self.mesh.of_corners}[domain]
        if name in of:
            return self.drop(name, f"there are two of that name of each {domain}")
        of[name] = rows[self._face_of] if domain == "face" else rows
        if labels:
            self.mesh.labels[name] = list(labels)

    def _by_corner(self, domain: str, rows: Array) -> Array:
        """(M, 3, ...) of the triangles."""
        import numpy as np

        if domain == "vertex":
            return np.asarray(rows[self.mesh.faces])
        if domain == "face":
            return rows[self._face_of].repeat(3, axis=0).reshape(-1, 3, rows.shape[1])
        return rows[self._corner_of]

    def _add_region(self, column: int, labels: Array) -> None:
        import numpy as np

        with np.errstate(invalid="ignore"):
            whole = labels.astype(np.int32)
        if not np.array_equal(whole, labels):
            return self.drop(REGIONS[column], "labels of regions are whole numbers of 32 bits")
        if self.mesh.regions is None:
            self.mesh.regions = {"labels": np.zeros((len(self.mesh.faces), 2), np.int32), "background": 0, "names": {}}
        self.mesh.regions["labels"][:, column] = whole[self._face_of]


def _item(value: Any) -> Any:
    """The only number of an array, or a number."""
    import numpy as np

    return np.asarray(value).reshape(-1)[0]


def _numbered(texts: Array) -> tuple[Array, list[str]]:
    import numpy as np

    labels, numbers = np.unique(texts.astype(str), return_inverse=True)
    return numbers.reshape(texts.shape).astype(np.int32), [str(label) for label in labels]


def _storable(values: Array) -> Array:
    """In one of the types that attributes have."""
    import numpy as np

    kind, size = values.dtype.kind, values.dtype.itemsize
    if kind == "b":
        return values.astype(np.uint8)
    if kind == "f" and size not in (4, 8):
        return values.astype(np.float32 if size < 4 else np.float64)
    if kind in "iu" and size == 8:
        small = values.astype(np.int32)
        return small if np.array_equal(small, values) else values.astype(np.float64)
    return values if values.dtype.isnative else values.astype(values.dtype.newbyteorder("="))


def _as_color(rows: Array) -> Array:
    """Some formats have numbers of 0 to 255 as floats; an alpha that hides nothing is none."""
    import numpy as np

    if rows.dtype.kind == "f" and rows.size and float(np.nanmax(rows)) > 1 and np.array_equal(rows, np.rint(rows)):
        rows = rows.clip(0, 255).astype(np.uint8)
    opaque = 1 if rows.dtype.kind == "f" else np.iinfo(rows.dtype).max
    return rows[:, :3] if rows.shape[1] == 4 and bool((rows[:, 3] == opaque).all()) else rows


def joined(name: str, meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one, with the regions of all where each has them. Where one has not what others have, it is NaN
    there, and white for colours."""
    import numpy as np

    if len(meshes) == 1:
        return meshes[0]
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [np.asarray(mesh.faces) + start for mesh, start in zip(meshes, first)]
    made = Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))
    made.name = name
    for domain in ("of_vertices", "of_faces", "of_corners"):
        counts = [len(mesh.vertices if domain == "of_vertices" else mesh.faces) for mesh in meshes]
        for key in dict.fromkeys(key for mesh in meshes for key in getattr(mesh, domain)):
            parts = [getattr(mesh, domain).get(key) for mesh in meshes]
            shape = max((part.shape[1:] for part in parts if part is not None), key=len)
            width = max((part.shape[-1] for part in parts if part is not None and part.ndim > 1), default=0)
            shape = (*shape[:-1], width) if shape else shape
            numbers = [_renumbered(mesh, key, made) for mesh in meshes]
            getattr(made, domain)[key] = np.concatenate(
                [_padded(part, count, shape, key, number) for part, count, number in zip(parts, counts, numbers)])
    made.regions = joined_regions(name, [mesh.regions for mesh in meshes])
    made.dropped = [*dict.fromkeys(pair for mesh in meshes for pair in mesh.dropped)]
    materials = [mesh.material for mesh in meshes if mesh.material is not None]
    if len(materials) == len(meshes) and all(material is materials[0] for material in materials):
        made.material = materials[0]
    elif materials:
        made.dropped.append(("texture", "the meshes have different ones"))
    return made


def _renumbered(mesh: Mesh, key: str, made: Mesh) -> Optional[dict[int, int]]:
    """Of the labels of one mesh their numbers among those of all."""
    if key not in mesh.labels:
        return None
    labels = [*made.labels.get(key, [])]
    labels.extend(label for label in mesh.labels[key] if label not in labels)
    made.labels[key] = labels
    return {number: labels.index(label) for number, label in enumerate(mesh.labels[key])}


def _padded(part: Optional[Array], count: int, shape: tuple[int, ...], key: str, numbers: Optional[dict[int, int]]) -> Array:
    import numpy as np

    if part is None:
        return np.full((count, *shape), 255, np.uint8) if key == "color" else np.full((count, *shape), np.nan, np.float32)
    if numbers is not None:
        return np.array([numbers.get(int(value), -1) for value in part], np.int32)
    if part.ndim > 1 and part.shape[-1] < shape[-1]:  # colours without an alpha
        opaque = 1 if part.dtype.kind == "f" else np.iinfo(part.dtype).max
        return np.concatenate([part, np.full((*part.shape[:-1], 1), opaque, part.dtype)], axis=-1)
    return part
