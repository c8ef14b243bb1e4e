"""Meshes, points and volumes that a run can start from, with what belongs to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Mapping, Optional, Sequence, Tuple

from ._arrays import shape_of
from ._exchange import to_package
from ._usd import Origin

if TYPE_CHECKING:
    import meshio  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import pyvista  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import trimesh  # type: ignore[import-not-found, import-untyped, unused-ignore]


def rows_in(values: Any) -> str:
    """How many there are, without a copy; "?" where that cannot be told."""
    shape = getattr(values, "shape", None)
    try:
        return str(shape[0] if shape is not None else len(values))
    except (TypeError, IndexError):
        return "?"


def lattice_text(values: Any) -> str:
    """The size of an array and its type."""
    return " x ".join(map(str, shape_of(values))) + f" {getattr(values, 'dtype', 'numbers')}"


def counts_text(vertices: Any, faces: Any, names: Sequence[str], regions: int) -> str:
    """What there is of a mesh."""
    text = f"{rows_in(vertices)} vertices, {rows_in(faces)} faces"
    text += f", {regions} regions" if regions else ""
    return text + (f", attributes {', '.join(names)}" if names else "")


def regions_in(regions: Optional[Mapping[str, Any]]) -> int:
    """How many regions faces part, without the background."""
    import numpy as np

    if not regions or not len(regions["labels"]):
        return 0
    labels = np.unique(np.asarray(regions["labels"]))
    return int(np.count_nonzero(labels != regions.get("background", 0)))


class Mesh:
    """Triangles with attributes, which the result keeps: see the option `attributes`.

    Where uv, texnumber or values with labels jump, the result has edges. A Result that is a source has its attributes
    and regions.

    Args:
        vertices: (K, 3), world units.
        faces: (M, 3), whole numbers.
        of_vertices: by name (K,) numbers, and "color" (K, 3) or (K, 4): of whole numbers parts of the largest of their
            type, otherwise 0 to 1.
        of_faces: by name (M,) numbers, and "color" (M, 3) or (M, 4).
        of_corners: "uv" (M, 3, 2), further sets of them "uv1", "uv2", and "normal" (M, 3, 3).
        labels: by name the names that an attribute's values are the numbers of, -1 being none: "material", for one.
        velocities: (K, 3) world units a frame, used as float32: where the vertices go until the next frame of
            remesh_sequence(), which uses them where that has other faces; NaN where nothing is known.
        regions: those that faces part, as Result.regions has them: "labels" (M, 2), of each face the region behind it and
            the one that its normal points into; "background", and "names" by label.

    Attributes:
        name: what messages call it.
        dropped: what the mesh had that it was made of, and this has not, each with the reason; for report["attributes"].
        material: what trimesh has to show texture coordinates with; to_trimesh() of a result gives it back.
        origin: of a mesh from a scene, what that says of axes, units and materials: see isoshell.usd.
    """

    def __init__(self, vertices: Any, faces: Any, *, of_vertices: Optional[Mapping[str, Any]] = None,
                 of_faces: Optional[Mapping[str, Any]] = None, of_corners: Optional[Mapping[str, Any]] = None,
                 labels: Optional[Mapping[str, Sequence[str]]] = None, velocities: Any = None,
                 regions: Optional[Mapping[str, Any]] = None) -> None:
        self.vertices = vertices
        self.faces = faces
        self.of_vertices = dict(of_vertices or {})
        self.of_faces = dict(of_faces or {})
        self.of_corners = dict(of_corners or {})
        self.labels = dict(labels or {})
        self.velocities = velocities
        self.regions = None if regions is None else dict(regions)
        self.name = "mesh"
        self.dropped: List[Tuple[str, str]] = []
        self.material: Any = None
        self.origin: Optional[Origin] = None

    def to_trimesh(self) -> trimesh.Trimesh:
        """The same as of a Result."""
        made: trimesh.Trimesh = to_package("_trimesh", self)
        return made

    def to_pyvista(self) -> pyvista.PolyData:
        """The same as of a Result."""
        made: pyvista.PolyData = to_package("_pyvista", self)
        return made

    def to_meshio(self) -> meshio.Mesh:
        """The same as of a Result."""
        made: meshio.Mesh = to_package("_meshio", self)
        return made

    def __repr__(self) -> str:
        return f"<isoshell.Mesh: {self._counts()}>"

    def _counts(self) -> str:
        names = [*self.of_vertices, *self.of_faces, *self.of_corners]
        return counts_text(self.vertices, self.faces, names, regions_in(self.regions))


class Points:
    """A point cloud; its surface is found by Poisson reconstruction.

    Args:
        positions: (K, 3), world units.
        normals: (K, 3), outward directions of any length; without them they are estimated.
    """

    def __init__(self, positions: Any, normals: Any = None) -> None:
        self.positions = positions
        self.normals = normals

    def __repr__(self) -> str:
        return f"<isoshell.Points: {rows_in(self.positions)} points{'' if self.normals is None else ', normals'}>"


def is_vdb_grid(value: Any) -> bool:
    """Whether it is a grid of OpenVDB's module, whichever that is: pyopenvdb or openvdb."""
    return hasattr(value, "evalActiveVoxelBoundingBox") and hasattr(value, "transform")


class Volume:
    """Values on a regular lattice: a CT, a segmentation, a simulation; as an array, or sparse.

    The surface is where the values, interpolated, are `iso`, which remesh() takes; of booleans the border of what is
    True. Without `iso` the values are distances: negative inside, or unsigned. NaN, and masked values, are not known:
    beside them the surface is open, and holes are closed or, by boundary="keep", kept. As a sizing field it holds edge
    lengths, and NaN where it says nothing.

    Args:
        values: (X, Y, Z) numbers, used as float32; values[i, j, k] stands at origin + (i, j, k) * spacing. Where the
            array begins with z, give values.transpose(2, 1, 0): that takes no copy. With coordinates (K,) numbers. Or
            what knows where it stands: a grid of OpenVDB's module (pyopenvdb, openvdb) or an isoshell.LevelSet, and
            bytes, which are those of a .vdb or .nvdb file, or of a grid of NanoVDB as it is in memory (of an array of
            bytes its memoryview). Of a grid, level set or file of whole numbers the result has
            regions.
        spacing: world units from a value to the next, above 0, one number or one an axis.
        origin: where values[0, 0, 0] stands, world units.
        velocities: (X, Y, Z, 3) world units a frame, used as float32: where the surface goes until the next frame of
            remesh_sequence(); NaN where nothing is known.
        sides: where a surface ends that reaches the sides of the array. "sample": at the outermost values, with flat
            faces; "cell": the same half a voxel farther out, as for values in the middle of voxels; "open": at the
            outermost values, with a border, which boundary="keep" keeps. None is "cell" for booleans, for others "open"
            with boundary="keep" and "sample" without.
        periodic: axes of the array, as "x,y,z", along which it goes on with its first values, as a gyroid does: the
            result is one period, a region with the label 1, and opposite sides have the same triangles, translated.
            It has creases at its sides alone, and beside these keeps an eighth of a cell from the places of values. No
            sizing field has this. An affine must have the array's axes along those of the world.
        affine: (4, 4), from (i, j, k, 1) to world units, as nibabel has it; instead of spacing and origin. It may turn,
            skew and mirror: the surface is that of the array, moved by it. Errors of code USAGE are one of another
            shape, with a last row other than 0, 0, 0, 1, or without an inverse, and one beside spacing or origin.
        coordinates: (K, 3) whole numbers: the voxel (i, j, k) that each of the values is of, each voxel once, in any
            order; they may be negative. Nothing dense is made of them. Takes 2 KiB for each block of 8^3 that has one.
        background: with coordinates, the value of all other voxels; without it the largest of the distances, with
            `iso` 0. Without `iso`, where some values are negative, other voxels that these enclose are inside.
    """

    def __init__(self, values: Any, spacing: Any = 1.0, origin: Any = 0.0, velocities: Any = None,
                 sides: Optional[str] = None, periodic: str = "", affine: Any = None, coordinates: Any = None,
                 background: Optional[float] = None) -> None:
        self.values = values
        self.spacing = spacing
        self.origin = origin
        self.velocities = velocities
        self.sides = sides
        self.periodic = periodic
        self.affine = affine
        self.coordinates = coordinates
        self.background = background

    def __repr__(self) -> str:
        if is_vdb_grid(self.values) or isinstance(self.values, (bytes, bytearray, memoryview)) or hasattr(self.values, "to_array"):
            return f"<isoshell.Volume: {type(self.values).__name__}>"
        place = f"spacing {self.spacing}, origin {self.origin}" if self.affine is None else "with an affine"
        return f"<isoshell.Volume: {lattice_text(self.values)}, {place}>"
