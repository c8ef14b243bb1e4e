"""What a run can start from."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, Mapping, Optional, Protocol, Sequence, Tuple, Union

from ._arrays import array_of, triple_of
from ._errors import Error
from ._isoshell import RunResult, Source
from ._labels import Labels, lattice_of, values_of
from ._paths import path_text
from ._result import Result
from ._usd import Origin, is_usd

if TYPE_CHECKING:
    import numpy as np


Named = Tuple[str, str, Any, List[str]]  # an attribute: name, domain, values, labels


class MeshLike(Protocol):
    """Anything with vertices (K, 3) and faces: a mesh of trimesh, a Result."""

    @property
    def vertices(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


class PolyDataLike(Protocol):
    """Anything with points (K, 3) and faces in one row, each behind its number of corners: a PolyData of pyvista."""

    @property
    def points(self) -> Any: ...

    @property
    def faces(self) -> Any: ...


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

    Attributes:
        name: what messages call it.
        origin: of a mesh from a scene, what that says of axes, units and materials: see isoshell.usd.
    """

    def __init__(self, vertices: Any, faces: Any, *, of_vertices: Optional[Mapping[str, Any]] = None,
                 of_faces: Optional[Mapping[str, Any]] = None, of_corners: Optional[Mapping[str, Any]] = None,
                 labels: Optional[Mapping[str, Sequence[str]]] = None, velocities: Any = None) -> None:
        self.vertices = vertices
        self.faces = faces
        self.of_vertices = dict(of_vertices or {})
        self.of_faces = dict(of_faces or {})
        self.of_corners = dict(of_corners or {})
        self.labels = dict(labels or {})
        self.velocities = velocities
        self.name = "mesh"
        self.origin: Optional[Origin] = None


class Points:
    """A point cloud; its surface is found by Poisson reconstruction.

    Args:
        positions: (K, 3), world units.
        normals: (K, 3), outward directions of any length; without them they are estimated.
    """

    def __init__(self, positions: Any, normals: Any = None) -> None:
        self.positions = positions
        self.normals = normals


class Volume:
    """Values on a regular lattice: a CT, a segmentation, a simulation.

    The surface is where the values, interpolated, are `iso`, which remesh() takes; of booleans the border of what is
    True. Without `iso` the values are distances: negative inside, or unsigned. As a sizing field it holds edge lengths,
    and NaN where it says nothing.

    Args:
        values: (X, Y, Z) numbers, used as float32; values[i, j, k] stands at origin + (i, j, k) * spacing. Where the
            array begins with z, give values.transpose(2, 1, 0): that takes no copy.
        spacing: world units from a value to the next, one number or one an axis.
        origin: where values[0, 0, 0] stands, world units.
        velocities: (X, Y, Z, 3) world units a frame, used as float32: where the surface goes until the next frame of
            remesh_sequence(); NaN where nothing is known.
    """

    def __init__(self, values: Any, spacing: Any = 1.0, origin: Any = 0.0, velocities: Any = None) -> None:
        self.values = values
        self.spacing = spacing
        self.origin = origin
        self.velocities = velocities


SourceLike = Union[str, "os.PathLike[str]", Mesh, Points, Volume, Labels, MeshLike, PolyDataLike,
                   Tuple[Any, Any]]


def opened(given: Any) -> Any:
    """Files that are read here and not by the library, as meshes; anything else as it is."""
    if not is_usd(given):
        return given
    from . import usd

    return usd.read(given)


def source_of(given: Any, sizing: Optional[Volume] = None) -> Source:
    """The source that an argument of remesh() means, with a sizing field that is in memory."""
    source = _source_of(opened(given))
    if sizing is not None:
        source.set_sizing(*_lattice_of("sizing", sizing))
    return source


def frame_source_of(given: Any, sizing: Optional[Volume] = None) -> Source:
    """The same for a frame of a sequence, with the velocities that are in memory."""
    source = source_of(given, sizing)
    if isinstance(given, Volume) and given.velocities is not None:
        vectors = _vectors_of(given.velocities, array_of("volume", given.values).shape)
        source.set_velocities(vectors, triple_of("spacing", given.spacing), triple_of("origin", given.origin))
    elif isinstance(given, Mesh) and given.velocities is not None:
        vertices = array_of("vertices", given.vertices)
        source.set_velocities_of_vertices(_vectors_of(given.velocities, vertices.shape[:1]), vertices,
                                          array_of("faces", given.faces))
    return source


def _vectors_of(velocities: Any, of_shape: Tuple[int, ...]) -> np.ndarray[Any, Any]:
    import numpy as np

    vectors = array_of("velocities", velocities)
    if vectors.shape != (*of_shape, 3):
        raise Error(f"velocities must have the shape {(*of_shape, 3)}, three numbers for each place, and has "
                    f"{vectors.shape}")
    return vectors.astype(np.float32, copy=False)


def _source_of(given: Any) -> Source:
    if isinstance(given, (str, os.PathLike)):
        return Source.file(path_text(given))
    if isinstance(given, Points):
        normals = None if given.normals is None else array_of("normals", given.normals)
        return Source.points(array_of("points", given.positions), normals)
    if isinstance(given, Volume):
        return Source.volume(*_lattice_of("volume", given))
    if isinstance(given, Labels):
        return Source.labels(values_of(given), lattice_of(given))
    if isinstance(given, (tuple, list)) and len(given) == 2:
        return _source_of_faces("(vertices, faces)", given[0], given[1])
    if isinstance(given, Result):
        named = [attribute for attribute in given._named_attributes() if attribute[0] != "gap"]
        return _source_of_triangles("result", given.vertices, given.faces, named, given._made)
    if isinstance(given, Mesh):
        return _source_of_triangles(given.name, given.vertices, given.faces, _attributes_of(given))
    for name in ("vertices", "points"):
        vertices, faces = getattr(given, name, None), getattr(given, "faces", None)
        if vertices is not None and faces is not None:
            return _source_of_faces(type(given).__name__, vertices, faces)
    raise Error("source must be a path, (vertices, faces), an object with vertices and faces, isoshell.Mesh, Points, "
                f"Volume or Labels, and is {type(given).__name__}")


def sizing_of(options: dict[str, Any]) -> Optional[Volume]:
    """Takes a sizing field in memory out of the options; one in a file stays there."""
    return options.pop("sizing") if isinstance(options.get("sizing"), Volume) else None


def is_true_or_false(volume: Any) -> bool:
    """Whether it is a Volume of booleans, whose surface needs no isovalue."""
    if not isinstance(volume, Volume):
        return False
    kind = getattr(volume.values, "dtype", None)  # "bool", "torch.bool"; arrays of devices are copied once, not here
    return str(kind).endswith("bool") if kind is not None else array_of("volume", volume.values).dtype.kind == "b"


def _source_of_faces(name: str, vertices: Any, faces: Any) -> Source:
    import numpy as np

    positions = array_of("vertices", vertices)
    if _is_ragged(faces):
        sizes = np.array([len(face) for face in faces], np.int64)
        corners = [corner for face in faces for corner in face]
        return Source.polygons(name, positions, sizes, array_of("faces", corners))
    indices = array_of("faces", faces)
    if indices.ndim == 1 and indices.size > 0:
        return Source.polygons(name, positions, *_counted_faces(indices))
    if indices.ndim == 2 and indices.shape[1] > 3:
        sizes = np.full(indices.shape[0], indices.shape[1], np.int64)
        return Source.polygons(name, positions, sizes, indices.reshape(-1))
    return Source.triangles(name, positions, indices, [], None)


def _attributes_of(mesh: Mesh) -> list[Named]:
    domains = {"vertex": mesh.of_vertices, "face": mesh.of_faces, "corner": mesh.of_corners}
    return [(name, domain, values, list(mesh.labels.get(name, [])))
            for domain, values_of in domains.items() for name, values in values_of.items()]


def _source_of_triangles(name: str, vertices: Any, faces: Any, attributes: Sequence[Named],
                         regions_of: Optional[RunResult] = None) -> Source:
    given = [(attribute.removesuffix(f":{domain}"), domain, _rows(attribute, domain, values), labels)
             for attribute, domain, values, labels in attributes]
    return Source.triangles(name, array_of("vertices", vertices), array_of("faces", faces), given, regions_of)


def _rows(name: str, domain: str, values: Any) -> np.ndarray[Any, Any]:
    """Values of an attribute as one row each."""
    import numpy as np

    array = array_of(f"the attribute '{name}'", values)
    if array.dtype.kind == "b":
        array = array.astype(np.uint8)
    if array.dtype in (np.int64, np.uint64):
        small = array.astype(np.int32)
        if not np.array_equal(small, array):
            raise Error(f"the attribute '{name}' has whole numbers of more than 32 bits; give float64")
        array = small
    if domain == "corner":
        if array.ndim != 3 or array.shape[1] != 3:
            raise Error(f"the attribute '{name}' of corners must have the shape (M, 3, ...), and has {array.shape}")
        array = array.reshape(-1, array.shape[2])
    if array.ndim not in (1, 2):
        raise Error(f"the attribute '{name}' must have a row for each of its elements, and has the shape {array.shape}")
    return array.reshape(array.shape[0], -1) if array.size else array.reshape(array.shape[0], 1)


def _is_ragged(faces: Any) -> bool:
    if not isinstance(faces, (list, tuple)):
        return False
    try:
        return len({len(face) for face in faces}) > 1
    except TypeError:
        return False


def _counted_faces(faces: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Sizes and corners of faces in one row, each behind its number of corners."""
    import numpy as np

    if faces.dtype.kind not in "iu":
        raise Error(f"faces must be whole numbers, such as int32 or int64, and is {faces.dtype}")
    size = int(faces[0])
    if size > 0 and faces.size % (size + 1) == 0 and np.all(faces[:: size + 1] == size):
        rows = faces.reshape(-1, size + 1)
        return rows[:, 0], rows[:, 1:].reshape(-1)
    heads = []
    at = 0
    while at < faces.size:
        heads.append(at)
        size = int(faces[at])
        if size < 0 or at + size >= faces.size:
            raise Error(f"faces[{at}] is {size}, and {faces.size - at - 1} numbers follow; in one row each face stands "
                        "behind its number of corners, otherwise faces has the shape (M, 3)")
        at += size + 1
    is_corner = np.ones(faces.size, bool)
    is_corner[heads] = False
    return faces[heads], faces[is_corner]


def _lattice_of(argument: str, volume: Volume) -> tuple[Any, tuple[float, float, float], tuple[float, float, float]]:
    import numpy as np

    values = array_of(argument, volume.values)
    return (values.astype(np.float32, copy=False), triple_of("spacing", volume.spacing),
            triple_of("origin", volume.origin))
