"""Meshes of meshio, and files by it; and results as meshes of it."""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from .._errors import Error
from .._inputs import Mesh, Points
from .._labels import INT32
from . import package
from ._give import given_of
from ._take import Taker

if TYPE_CHECKING:
    import meshio  # type: ignore[import-not-found, import-untyped, unused-ignore]

    from .._result import Result

CORNERS = {"triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4}  # which come first
SIDES = {  # of volume cells, by their corners: outward
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
GMSH = {"gmsh:physical": "group"}
# Of an ending: the module of meshio. Its general functions try several formats, print, and exit where none fits.
MODULES = {"msh": "gmsh", "vtu": "vtu", "med": "med", "xdmf": "xdmf", "xmf": "xdmf", "inp": "abaqus"}
XDMF = ("xdmf", "xmf")
XDMF_TYPES = {"f": "Float", "i": "Int", "u": "UInt"}  # of numpy's kinds
ALONE = ("inp",)  # hold vertices and faces, and nothing else
WITHOUT_NAMES = ("vtu", "med", *XDMF)


def taken(given: Any, options: dict[str, Any]) -> Any:
    """A source of it: its faces, or the boundary of its volume cells where it has no faces, or a cloud of its points."""
    meshio = package("meshio", "an object of meshio")
    if not isinstance(given, meshio.Mesh):
        raise Error(f"source is a {type(given).__name__} of meshio; give a Mesh")
    blocks = [i for i, block in enumerate(given.cells) if _corners_of(block) and len(block.data)]
    if not blocks:
        return _taken_boundary(given)
    import numpy as np

    rows = [_rows(given.cells[i]) for i in blocks]
    sizes = np.concatenate([np.full(len(row), row.shape[1], np.int64) for row in rows])
    taker = Taker("Mesh", given.points, np.concatenate([row.reshape(-1) for row in rows]), sizes)
    for name, values in given.point_data.items():
        taker.add(name, "vertex", values)
    names = _names_of_groups(given, blocks)
    for name, parts in given.cell_data.items():
        values = [np.asarray(parts[i]) for i in blocks]
        if name in GMSH and names:
            taker.add(GMSH[name], "face", [names.get(int(v), str(v)) for part in values for v in part])
        elif len({value.shape[1:] for value in values}) == 1:
            taker.add(name, "face", np.concatenate(values))
        else:
            taker.drop(name, "its blocks have different numbers of values for each face")
    for name in [*given.point_sets, *given.cell_sets]:
        if not name.startswith("gmsh:"):
            taker.drop(name, "sets of points and cells are not kept")
    left_out = sorted({block.type for i, block in enumerate(given.cells) if i not in blocks})
    if left_out:
        taker.drop(", ".join(left_out), "cells that are no faces are left out")
    taker.add_names(_notes_of(given.field_data))
    return taker.mesh


def _corners_of(block: Any) -> int:
    return CORNERS.get(block.type, 1 if block.type.startswith("polygon") else 0)


def _rows(block: Any) -> Any:
    import numpy as np

    rows = np.asarray(block.data)
    return rows[:, :CORNERS[block.type]] if block.type in CORNERS else rows


def _names_of_groups(given: Any, blocks: list[int]) -> dict[int, str]:
    """Gmsh's physical groups of faces that have a name."""
    rows = {name: _whole_numbers(value) for name, value in given.field_data.items()}
    return {row[0]: name for name, row in rows.items() if len(row) == 2 and row[1] == 2 and ":" not in name}


def _taken_boundary(given: Any) -> Any:
    """The sides of volume cells that only one cell has."""
    import numpy as np

    sides: dict[int, list[Any]] = {3: [], 4: []}
    kinds = [(block, kind) for block in given.cells for kind in SIDES
             if block.type.rstrip("0123456789") == kind and len(block.data)]
    for block, kind in kinds:
        for side in SIDES[kind]:
            sides[len(side)].append(np.asarray(block.data)[:, list(side)])
    if not kinds:
        return Points(given.points)
    rows, sizes = [], []
    for size, parts in sides.items():
        if not parts:
            continue
        every = np.concatenate(parts)
        _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
        kept = every[np.sort(first[count == 1])]
        rows.append(kept.reshape(-1))
        sizes.append(np.full(len(kept), size, np.int64))
    taker = Taker("Mesh", given.points, np.concatenate(rows), np.concatenate(sizes))
    for name, values in given.point_data.items():
        taker.add(name, "vertex", values)
    for name in given.cell_data:
        taker.drop(name, "it is of volume cells, and their boundary is meshed")
    return taker.mesh


def given(made: Result | Mesh) -> meshio.Mesh:
    """A Mesh with copies of all that there is. Names of regions and labels are in field_data, as Gmsh's are: by name a
    number, and the dimension of what has it."""
    import numpy as np

    library = package("meshio", "to_meshio()")
    mesh = given_of(made)
    field_data = {}
    for name, number in zip(mesh.notes.get("region_names", []), mesh.notes.get("region_numbers", [])):
        field_data[f"region:{name}"] = np.array([number, 3])
    if mesh.notes.get("region_background", [0]) != [0]:
        field_data["region_background:"] = np.array([mesh.notes["region_background"][0], 3])
    for key, labels in mesh.notes.items():
        if key.endswith("_names") and key != "region_names":
            field_data.update({f"{key[:-6]}:{label}": np.array([i, 2]) for i, label in enumerate(labels)})
    made_here: meshio.Mesh = library.Mesh(
        mesh.vertices, [("triangle", mesh.faces)], point_data=dict(mesh.of_vertices),
        cell_data={name: [values] for name, values in mesh.of_faces.items()}, field_data=field_data)
    return made_here


def _notes_of(field_data: Any) -> dict[str, Any]:
    """What given() has made of names, back."""
    notes: dict[str, Any] = {"region_background": [0], "region_numbers": [], "region_names": []}
    for key, value in field_data.items():
        kind, is_named, name = str(key).partition(":")
        row = _whole_numbers(value)
        if not is_named or len(row) != 2:
            continue  # somebody else's
        number, dimension = row
        if kind == "region_background" and dimension == 3:
            notes[kind] = [number]
        elif kind == "region" and dimension == 3:
            notes["region_numbers"].append(number)
            notes["region_names"].append(name)
        elif dimension == 2 and 0 <= number < len(field_data):
            labels = notes.setdefault(f"{kind}_names", [])
            labels.extend([""] * (number + 1 - len(labels)))
            labels[number] = name
    return notes


def _whole_numbers(value: Any) -> list[int]:
    """Those of a note that a label can be; none where it has others."""
    import numpy as np

    row = np.atleast_1d(np.asarray(value))
    if row.dtype.kind not in "iu" or row.ndim != 1 or np.any((row < INT32[0]) | (row > INT32[1])):
        return []
    return [int(number) for number in row]


def read(path: str, options: dict[str, Any]) -> Any:
    """What a file has."""
    return taken(getattr(check(path), MODULES[_ending(path)]).read(path), options)


def write(made: Result | Mesh, path: str) -> list[str]:
    """Returns what the file does not hold."""
    library, ending = check(path), _ending(path)
    mesh, lost = given(made), []
    if ending in ALONE:
        lost = [*mesh.point_data, *mesh.cell_data]
        mesh = library.Mesh(mesh.points, mesh.cells)
    if mesh.field_data and ending in WITHOUT_NAMES:
        lost.append("names of " + ", ".join(sorted({key.partition(":")[0] for key in mesh.field_data})))
        mesh.field_data = {}
    if ending == "msh":
        _fit_gmsh(mesh)
    if ending in XDMF:
        _write_xdmf(mesh, path)
        return lost
    module = getattr(library, MODULES[ending])
    if ending != "med":
        module.write(path, mesh)
        return lost
    image = io.BytesIO()  # it does not close a file, and so does not say when that fails
    module.write(image, mesh)
    with open(path, "wb") as file:
        file.write(image.getbuffer())
    return lost


def files_beside(path: str) -> list[str]:
    """Other files that hold a part of that one: XDMF has its numbers in one of HDF5."""
    return [os.path.splitext(path)[0] + ".h5"] if _ending(path) in XDMF else []


def _write_xdmf(mesh: meshio.Mesh, path: str) -> None:
    """HDF5 in memory, as meshio does not close its file: where a disk is full, the process ends there, or nobody hears
    of it."""
    import h5py  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import numpy as np

    (beside,) = files_beside(path)
    image, root = io.BytesIO(), ElementTree.Element("Xdmf", Version="3.0")
    grid = ElementTree.SubElement(ElementTree.SubElement(root, "Domain"), "Grid", Name="Grid")
    with h5py.File(image, "w") as numbers:
        def add(values: Any, what: str, **words: str) -> None:
            """An element whose values are a data set."""
            name, rows = f"data{len(numbers)}", np.asarray(values)
            numbers.create_dataset(name, data=rows, compression="gzip")
            item = ElementTree.SubElement(
                ElementTree.SubElement(grid, what, words), "DataItem", DataType=XDMF_TYPES[rows.dtype.kind],
                Dimensions=" ".join(str(size) for size in rows.shape), Format="HDF", Precision=str(rows.dtype.itemsize))
            item.text = f"{os.path.basename(beside)}:/{name}"

        faces = mesh.cells[0].data
        add(mesh.points, "Geometry", GeometryType="XYZ")
        add(faces, "Topology", TopologyType="Triangle", NumberOfElements=str(len(faces)), NodesPerElement="3")
        of_faces = {name: parts[0] for name, parts in mesh.cell_data.items()}
        for center, data in (("Node", mesh.point_data), ("Cell", of_faces)):
            for name, values in data.items():
                width = values.shape[1] if values.ndim == 2 else 1
                add(values, "Attribute", Name=name, Center=center,
                    AttributeType={1: "Scalar", 2: "Vector", 3: "Vector", 6: "Tensor6", 9: "Tensor"}.get(width, "Matrix"))
    for name, content in ((beside, image.getbuffer()), (path, ElementTree.tostring(root))):
        with open(name, "wb") as file:
            file.write(content)


def _fit_gmsh(mesh: Any) -> None:
    """Gmsh has values of one, three or nine numbers."""
    import numpy as np

    for name, values in mesh.point_data.items():
        if values.ndim == 2 and values.shape[1] == 2:
            mesh.point_data[name] = np.column_stack([values, np.zeros(len(values))])


def check(path: str) -> Any:
    """The package, with the one that it needs for such a file."""
    if _ending(path) in ("med", *XDMF):
        package("h5py", f"{path}: this format")
    return package("meshio", f"{path}: this format")


def _ending(path: str) -> str:
    return os.path.splitext(path)[1][1:].lower()
