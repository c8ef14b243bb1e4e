"""What a run can start from."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, List, Mapping, Optional, Protocol, Sequence, Tuple, Union

from ._arrays import array_of, axes_of, first_place, floats_or_nan, masked_array_of, nan_where_masked, shape_of
from ._exchange import format_of, taken
from ._errors import Error
from ._grids import add_grids
from ._inputs import Mesh, Points, Volume
from ._isoshell import RunResult, Source
from ._labels import INT32, Labels, label_of, lattice_of, values_of
from ._lattice import origin_and_steps_of
from ._paths import encodable, path_text
from ._result import Result
from ._sparse import is_sparse, places_itself, sparse_source_of
from ._usd import is_usd

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


class SceneLike(Protocol):
    """A scene of trimesh."""

    @property
    def geometry(self) -> Any: ...

    @property
    def graph(self) -> Any: ...


class CellsLike(Protocol):
    """A mesh of meshio, or a data set of pyvista."""

    @property
    def points(self) -> Any: ...

    @property
    def point_data(self) -> Any: ...


class ImageLike(Protocol):
    """An image of nibabel."""

    @property
    def affine(self) -> Any: ...

    @property
    def dataobj(self) -> Any: ...


class ArrayLike(Protocol):
    """Vertices, where faces follow: remesh(V, F)."""

    @property
    def shape(self) -> Any: ...


SourceLike = Union[str, "os.PathLike[str]", Mesh, Points, Volume, Labels, MeshLike, PolyDataLike, SceneLike, CellsLike,
                   ImageLike, ArrayLike, Tuple[Any, Any], Sequence[Union[str, "os.PathLike[str]"]]]


def opened(given: Any, options: Optional[dict[str, Any]] = None) -> Any:
    """Files that are read here and not by the library, and objects of other packages, as meshes, points, volumes and
    labels; anything else as it is. What of the options only this reading needs is taken out of them."""
    options = {} if options is None else options
    if are_files(given):
        others = [path_text(path) for path in given if is_usd(path) or format_of(path) is not None]
        if others:
            raise Error(f"{others[0]}: several files are read together where they are level sets, of .vdb and .nvdb; read "
                        "this one alone")
        return given
    if is_usd(given):
        from . import usd

        return usd.read(given)
    if format_of(given) is not None and not options.get("input_format"):
        from ._exchange import _files

        return _files.read(os.fsdecode(given), options)
    return taken(given, options)


def are_files(given: Any) -> bool:
    """Whether it is several files, which are read together: level sets that become regions, or one surface."""
    return isinstance(given, (list, tuple)) and len(given) > 0 and all(isinstance(path, (str, os.PathLike)) for path in given)


def with_faces(source: Any, faces: Sequence[Any]) -> Any:
    """remesh(V, F) as remesh((V, F))."""
    if not faces:
        return source
    if len(faces) > 1 or isinstance(source, (str, os.PathLike)):
        raise Error("by position there is one source, or vertices and faces: remesh(V, F); several files are a list, and "
                    "everything else is by name")
    return source, faces[0]


def source_of(given: Any, sizing: Any = None, grids: Optional[Mapping[str, Any]] = None, max_bytes: int = 0) -> Source:
    """The source that what is opened means, with a sizing field and grids that are in memory; the limit is of each grid,
    and with 0 what is free."""
    source = _source_of(given)
    add_grids(source, grids or {}, given, max_bytes)
    if is_sparse(sizing):
        raise Error("sizing is a sparse volume; give an isoshell.Volume of an array, or a .vdb file of edge lengths")
    if isinstance(sizing, Volume):
        source.set_sizing(floats_or_nan("sizing", sizing.values), *origin_and_steps_of(sizing))
    elif sizing is not None:
        lengths = floats_or_nan("sizing", sizing)
        if lengths.ndim != 1:
            raise Error(f"sizing must be one edge length for each vertex, or an isoshell.Volume, and has the shape "
                        f"{lengths.shape}")
        source.set_sizing_of_vertices(lengths)
    return source


def frame_source_of(given: Any, sizing: Any = None) -> Source:
    """The same for a frame of a sequence, with the velocities that are in memory."""
    source = source_of(given, sizing)
    if isinstance(given, Volume) and given.velocities is not None:
        vectors = _vectors_of(given.velocities, shape_of(given.values))
        source.set_velocities(vectors, *origin_and_steps_of(given))
    elif isinstance(given, Mesh) and given.velocities is not None:
        vertices = array_of("vertices", given.vertices)
        source.set_velocities_of_vertices(_vectors_of(given.velocities, vertices.shape[:1]), vertices,
                                          array_of("faces", given.faces))
    return source


def _vectors_of(velocities: Any, of_shape: Tuple[int, ...]) -> np.ndarray[Any, Any]:
    vectors = floats_or_nan("velocities", velocities)
    if vectors.shape != (*of_shape, 3):
        raise Error(f"velocities must have the shape {(*of_shape, 3)}, three numbers for each place, and has "
                    f"{vectors.shape}")
    return vectors


def _source_of(given: Any) -> Source:
    if isinstance(given, (str, os.PathLike)):
        return Source.files([path_text(given)])
    if are_files(given):
        return Source.files([path_text(path) for path in given])
    if isinstance(given, Points):
        return Source.points(*_points_of(given))
    if is_sparse(given):
        return sparse_source_of(given)
    if isinstance(given, Volume):
        if given.sides not in (None, "sample", "cell", "open"):
            raise Error(f'sides must be "sample", "cell" or "open", and is {given.sides!r}')
        if given.background is not None:
            raise Error("background is the value around voxels that have coordinates; leave it out of an array")
        is_mask, periodic = is_true_or_false(given), axes_of("periodic", given.periodic)
        sides = given.sides or ("cell" if is_mask and not any(periodic) else "")
        return Source.volume(_values_of("volume", given.values), *origin_and_steps_of(given), sides, is_mask, periodic)
    if isinstance(given, Labels):
        return Source.labels(values_of(given), lattice_of(given))
    if isinstance(given, (tuple, list)) and len(given) == 2:
        return _source_of_faces("(vertices, faces)", given[0], given[1])
    if isinstance(given, Result):
        named = [attribute for attribute in given._named_attributes() if attribute[0] != "gap"]
        return _source_of_triangles("result", given.vertices, given.faces, named, given._made)
    if isinstance(given, Mesh):
        return _source_of_mesh(given)
    for name in ("vertices", "points"):
        vertices, faces = getattr(given, name, None), getattr(given, "faces", None)
        if vertices is not None and faces is not None:
            return _source_of_faces(type(given).__name__, vertices, faces)
    raise Error("source must be a path, (vertices, faces), an object with vertices and faces, isoshell.Mesh, Points, "
                f"Volume or Labels, or a mesh of trimesh, pyvista, meshio or PyMeshLab, and is {type(given).__name__}")


def sizing_of(options: dict[str, Any]) -> Any:
    """Takes a sizing field in memory out of the options; the name of a file, or of an attribute, stays there."""
    is_name = isinstance(options.get("sizing"), (str, os.PathLike))
    return None if is_name else options.pop("sizing", None)


def is_true_or_false(volume: Any) -> bool:
    """Whether it is a Volume of booleans, whose surface needs no isovalue."""
    if not isinstance(volume, Volume) or places_itself(volume.values):
        return False
    kind = getattr(volume.values, "dtype", None)  # "bool", "torch.bool"; arrays of devices are copied once, not here
    return str(kind).endswith("bool") if kind is not None else masked_array_of("volume", volume.values)[0].dtype.kind == "b"


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


def _points_of(given: Points) -> tuple[Any, Any]:
    """Positions and normals, without the points that have not both."""
    import numpy as np

    positions, mask = masked_array_of("points", given.positions)
    if given.normals is None:
        normals, other = None, None
    else:
        normals, other = masked_array_of("normals", given.normals)
    left_out = np.zeros(len(positions) if positions.ndim else 0, bool)
    for part in (mask, other):
        if part is not None and part.ndim == 2 and len(part) == len(left_out):
            left_out |= part.any(axis=1)
        elif part is not None:
            raise Error(f"points{first_place(part)} is masked; points and normals must be as many rows of three")
    if not left_out.any():
        return positions, normals
    return positions[~left_out], None if normals is None else normals[~left_out]


def _source_of_mesh(mesh: Mesh) -> Source:
    if mesh.regions is None:
        source = _source_of_triangles(mesh.name, mesh.vertices, mesh.faces, _attributes_of(mesh))
    else:
        source = _source_of_regions(mesh, mesh.regions)
    if mesh.dropped:
        source.set_dropped(mesh.dropped)
    return source


def _source_of_regions(mesh: Mesh, regions: Mapping[str, Any]) -> Source:
    """With faces that have the lesser label behind them and the background in front, as the library wants them."""
    import numpy as np

    if "labels" not in regions:
        raise Error("regions must have 'labels', two for each face, as Result.regions has them")
    labels = array_of("regions['labels']", regions["labels"])
    faces = array_of("faces", mesh.faces)
    if faces.ndim != 2 or faces.shape[1] != 3:
        raise Error(f"faces must be rows of three, of the shape (M, 3), where there are regions, and has the shape {faces.shape}")
    if labels.shape != (len(faces), 2) or labels.dtype.kind not in "iu":
        raise Error(f"regions['labels'] must be whole numbers of the shape ({len(faces)}, 2), two for each face, and is "
                    f"{labels.dtype} of the shape {labels.shape}")
    wrong = np.argwhere((labels < INT32[0]) | (labels > INT32[1]))
    if len(wrong):
        label_of(f"regions['labels']{wrong[0].tolist()}", labels[tuple(wrong[0])])
    background = label_of("regions['background']", regions.get("background", 0))
    behind, front = labels[:, 0], labels[:, 1]
    turned = (front != background) & ((behind == background) | (behind > front))
    order = np.where(turned[:, None], [0, 2, 1], [0, 1, 2])
    attributes = []
    for name, domain, values, names in _attributes_of(mesh):
        if domain == "corner":
            array = array_of(f"the attribute '{name}'", values)
            values = array[np.arange(len(array))[:, None], order] if len(array) == len(faces) else array
        attributes.append((name, domain, values, names))
    source = _source_of_triangles(mesh.name, mesh.vertices, np.take_along_axis(faces, order, axis=1), attributes)
    source.set_regions(np.where(turned[:, None], labels[:, ::-1], labels).astype(np.int32, order="C"), background,
                       {label_of("a key of names", k): encodable(str(v)) for k, v in (regions.get("names") or {}).items()})
    return source


def named_of(made: Result | Mesh) -> list[Named]:
    """Everything that it has beside its positions, as arrays."""
    if isinstance(made, Result):
        return made._named_attributes()
    return [(name, domain, array_of(f"the attribute '{name}'", values), labels)
            for name, domain, values, labels in _attributes_of(made)]


def _attributes_of(mesh: Mesh) -> list[Named]:
    domains = {"vertex": mesh.of_vertices, "face": mesh.of_faces, "corner": mesh.of_corners}
    return [(_name_of(name), domain, values, [encodable(str(label)) for label in mesh.labels.get(name, [])])
            for domain, values_of in domains.items() for name, values in values_of.items()]


def _name_of(attribute: Any) -> str:
    if not isinstance(attribute, str):
        raise Error(f"the name of an attribute is {attribute!r}; it must be text")
    return encodable(attribute)


def _source_of_triangles(name: str, vertices: Any, faces: Any, attributes: Sequence[Named],
                         regions_of: Optional[RunResult] = None) -> Source:
    given = [(attribute.removesuffix(f":{domain}"), domain, _rows(attribute, domain, values), labels)
             for attribute, domain, values, labels in attributes]
    return Source.triangles(name, array_of("vertices", vertices), array_of("faces", faces), given, regions_of)


def _rows(name: str, domain: str, values: Any) -> np.ndarray[Any, Any]:
    """Values of an attribute as one row each."""
    import numpy as np

    array = nan_where_masked(f"the attribute '{name}'", values)
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


def _values_of(argument: str, values: Any) -> np.ndarray[Any, Any]:
    """Of a volume: where a mask of what is inside has no value, that is outside; others are not known there."""
    import numpy as np

    array, mask = masked_array_of(argument, values)
    if mask is not None and array.dtype.kind == "b":
        return np.asarray(array & ~mask, np.float32)
    known = array.astype(np.float32, copy=False)
    return known if mask is None else np.where(mask, np.float32(np.nan), known)
