"""Data sets of pyvista and VTK, and files by them; and results as meshes of pyvista."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Iterator, Optional

from .._errors import Error
from .._inputs import Mesh, Points, Volume
from .._isoshell import ErrorCode
from . import package
from ._give import given_of
from ._take import Taker, joined

if TYPE_CHECKING:
    import pyvista  # type: ignore[import-not-found, import-untyped, unused-ignore]

    from .._result import Result


def taken(given: Any, options: dict[str, Any]) -> Any:
    """A source of it: of grids of cells their surface, of an image its active scalars, of points without faces a cloud.

    Raises:
        Error: of code USAGE for what has none of them.
    """
    library = package("pyvista", f"a {type(given).__name__}")
    data = library.wrap(given)
    if isinstance(data, library.MultiBlock):
        surfaces = [surface for surface in _surfaces_in(library, data) if surface.GetNumberOfPolys()]
        if surfaces:
            return joined(type(given).__name__, [_taken_surface(type(given).__name__, each) for each in surfaces])
        data = data.combine()
    if isinstance(data, library.ImageData):
        return _taken_image(data)
    data = _surface_of(library, data)
    if isinstance(data, library.PointSet):
        return _taken_points(data)
    if not isinstance(data, library.PolyData):
        raise Error(f"source is a {type(given).__name__} of pyvista, which has no surface; give a PolyData, a grid, an "
                    "ImageData or a PointSet")
    return _taken_surface(type(given).__name__, data) if data.GetNumberOfPolys() else _taken_points(data)


def _surface_of(library: Any, data: Any) -> Any:
    """Of cells their surface, and of strips their triangles; what is no data set as it is."""
    if isinstance(data, library.DataSet) and not isinstance(data, (library.PolyData, library.PointSet)):
        data = data.extract_surface(algorithm="dataset_surface") if data.n_cells else library.PolyData(data.points)
    return data.triangulate() if isinstance(data, library.PolyData) and data.n_strips else data


def _surfaces_in(library: Any, blocks: Any) -> Iterator[Any]:
    """Those of all blocks, and of the blocks in them."""
    for block in (blocks[i] for i in range(blocks.n_blocks)):
        if isinstance(block, library.MultiBlock):
            yield from _surfaces_in(library, block)
        elif isinstance(block, library.DataSet):
            surface = _surface_of(library, block)
            if isinstance(surface, library.PolyData):
                yield surface


def _taken_surface(name: str, data: Any) -> Mesh:
    import numpy as np

    ids = data.GetPolys()
    offsets = library_array(ids.GetOffsetsArray())
    taker = Taker(name, data.points, library_array(ids.GetConnectivityArray()), np.diff(offsets))
    meant = ((data.GetPointData().GetTCoords(), "uv"), (data.GetPointData().GetNormals(), "normal"))
    meanings = {array.GetName(): meaning for array, meaning in meant if array is not None}
    for key in data.point_data.keys():
        taker.add(meanings.get(key, key), "vertex", np.asarray(data.point_data[key]))
    others = data.n_cells - data.GetNumberOfPolys()  # points and lines, which come first
    for key in data.cell_data.keys():
        taker.add(key, "face", np.asarray(data.cell_data[key])[others:])
    taker.add_names({key: list(data.field_data[key]) for key in data.field_data.keys()})
    return taker.mesh


def library_array(array: Any) -> Any:
    """An array of VTK as one of numpy."""
    support: Any = importlib.import_module("vtkmodules.util.numpy_support")
    return support.vtk_to_numpy(array)


def _taken_points(data: Any) -> Points:
    normals: Optional[Any] = data.GetPointData().GetNormals()
    return Points(data.points, None if normals is None else library_array(normals))


def _taken_image(data: Any) -> Volume:
    """The active scalars, of its points or else of its cells."""
    import numpy as np

    of_points, size = data.point_data.active_scalars, np.array(data.dimensions)
    values = of_points if of_points is not None else data.cell_data.active_scalars
    if values is None or np.ndim(values) != 1:
        raise Error("source is an ImageData whose active scalars are not one number a point or a cell; choose others by "
                    "set_active_scalars")
    shape, shift = (size, 0.0) if of_points is not None else (np.maximum(size - 1, 1), 0.5)
    first = np.array(data.extent[::2]) + shift
    affine = np.eye(4)
    affine[:3, :3] = np.array(data.direction_matrix) * data.spacing
    affine[:3, 3] = data.origin + affine[:3, :3] @ first
    return Volume(np.asarray(values).reshape(tuple(shape), order="F"), affine=affine)


def given(made: Result | Mesh) -> pyvista.PolyData:
    """A PolyData with copies of all that there is."""
    import numpy as np

    library = package("pyvista", "to_pyvista()")
    mesh = given_of(made)
    faces = np.column_stack([np.full(len(mesh.faces), 3, np.int64), mesh.faces]).ravel()
    data: pyvista.PolyData = library.PolyData(mesh.vertices, faces)
    for name, values in mesh.of_vertices.items():
        data.point_data[name] = values
    for name, values in mesh.of_faces.items():
        data.cell_data[name] = values
    if "uv" in mesh.of_vertices:
        data.GetPointData().SetActiveTCoords("uv")
    if "normal" in mesh.of_vertices:
        data.GetPointData().SetActiveNormals("normal")
    for name, values in mesh.notes.items():
        if len(values):
            data.field_data[name] = np.array(values)
    return data


def check(path: str) -> Any:
    """The package."""
    return package("pyvista", f"{path}: this format")


def read(path: str, options: dict[str, Any]) -> Any:
    """What a file has."""
    return taken(check(path).read(path), options)


def write(made: Result | Mesh, path: str) -> list[str]:
    """Returns what the file does not hold: nothing."""
    check(path)
    with open(path, "wb") as file:
        file.write(_image(given(made), path))
    return []


def _image(data: pyvista.PolyData, path: str) -> bytes:
    """The file, in memory: VTK ends the process where a disk is full."""
    from vtkmodules.vtkIOLegacy import vtkPolyDataWriter  # type: ignore[import-not-found, import-untyped, unused-ignore]
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter  # type: ignore[import-not-found, import-untyped, unused-ignore]

    is_xml = path.lower().endswith(".vtp")
    writer: Any = vtkXMLPolyDataWriter() if is_xml else vtkPolyDataWriter()
    writer.SetDataModeToBinary() if is_xml else writer.SetFileTypeToBinary()
    writer.SetInputData(data)
    writer.SetWriteToOutputString(True)
    if not writer.Write():
        raise Error(f"{path}: VTK does not write it", ErrorCode.UNWRITABLE_OUTPUT, "write")
    return bytes(writer.GetOutputString().encode() if is_xml else writer.GetOutputStdString())


def files_beside(path: str) -> list[str]:
    """Other files that hold a part of that one: none."""
    return []
