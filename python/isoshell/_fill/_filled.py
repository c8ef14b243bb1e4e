"""Tetrahedra in the regions of a result."""

from __future__ import annotations

import importlib
import os
import tempfile
from typing import TYPE_CHECKING, Any, Sequence

from .. import _isoshell
from .._errors import Error, words_of
from .._exchange import package
from .._paths import path_text, writing
from ._mesh_parts import by_gmsh, by_tetgen
from ._shells import Part, parts_of, volume_of

if TYPE_CHECKING:
    import meshio  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import numpy as np

    from .._result import Result

    Array = np.ndarray[Any, np.dtype[Any]]

MESHERS = {"tetgen": by_tetgen, "gmsh": by_gmsh}
ENDINGS = {"msh": "gmsh", "vtu": "vtu", "inp": "abaqus"}  # with meshio's modules
FILLED = 0.999  # of the volume of a piece, at least


class Filled:
    """Tetrahedra in the regions of a result, on its very surface.

    Attributes:
        vertices: (N, 3) float64, world units; the first of them are those of the result, with the same numbers.
        tetrahedra: (T, 4) int32, the fourth corner on the side from which the others run counter-clockwise.
        regions: (T,) int32, the label of the region that each is in; 1 where the result has no regions.
        region_names: what regions are called, by label; without those that have no name.
    """

    def __init__(self, vertices: Array, tetrahedra: Array, regions: Array, names: dict[int, str]) -> None:
        self.vertices = vertices
        self.tetrahedra = tetrahedra
        self.regions = regions
        self.region_names = names

    def volume(self, label: int) -> float:
        """Of a region, cubic world units; 0 for a label that none has."""
        return float(_volumes(self.vertices, self.tetrahedra[self.regions == label]).sum())

    def to_meshio(self) -> meshio.Mesh:
        """A meshio.Mesh with cell_data "region", and physical groups and sets of cells with the names of regions. Needs
        meshio."""
        import numpy as np

        library: Any = package("meshio", "to_meshio()")
        names = {label: self.region_names.get(label, f"region {label}") for label in np.unique(self.regions).tolist()}
        mesh: meshio.Mesh = library.Mesh(
            self.vertices, [("tetra", self.tetrahedra)],
            cell_data={name: [self.regions] for name in ("region", "gmsh:physical", "gmsh:geometrical")},
            field_data={name: np.array([label, 3]) for label, name in names.items()},
            cell_sets={name: [np.flatnonzero(self.regions == label)] for label, name in names.items()})
        return mesh

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Write .msh (Gmsh), .vtu or .inp (Abaqus), through meshio. Regions are physical groups, `region` of cells, and
        sets of elements there.

        Raises:
            Error: of code UNWRITABLE_OUTPUT when it cannot be written, or is there and overwrite is not True; of code
                USAGE for another ending.
        """
        text = path_text(path)
        ending = check_target(text, overwrite)
        mesh = self.to_meshio()
        if ending != "msh":
            mesh.cell_data = {"region": mesh.cell_data["region"]} if ending == "vtu" else {}
            mesh.field_data = {}
        mesh.cell_sets = {name.replace(" ", "_"): cells for name, cells in mesh.cell_sets.items()} if ending == "inp" else {}
        module = importlib.import_module(f"meshio.{ENDINGS[ending]}")
        version = {"fmt_version": "2.2"} if ending == "msh" else {}  # which has a number of each cell
        with writing(text), tempfile.TemporaryDirectory(prefix=".isoshell-", dir=os.path.dirname(text) or ".") as work:
            part = os.path.join(work, os.path.basename(text))
            module.write(part, mesh, **version)
            _isoshell.put_in_place(part, text, overwrite)

    def __repr__(self) -> str:
        return f"<isoshell.Filled: {len(self.vertices)} vertices, {len(self.tetrahedra)} tetrahedra>"


def check_target(path: str, overwrite: bool, others: Sequence[tuple[str, str]] = ()) -> str:
    """Before a run: the ending of a file, which tetrahedra could be written to beside others of the run.

    Raises:
        Error: of code UNWRITABLE_OUTPUT or USAGE.
    """
    ending = os.path.splitext(path)[1][1:].lower()
    if ending not in ENDINGS:
        raise Error(f"{path}: tetrahedra are written as .{', .'.join(ENDINGS)}", stage="options")
    _isoshell.check_output_files([("the tetrahedra", path), *others], [], overwrite, "")
    return ending


def fill(result: Result, mesher: str = "tetgen", quality: float = 1.4) -> Filled:
    """See Result.fill()."""
    import numpy as np

    if mesher not in MESHERS:
        raise Error(f"mesher is {mesher!r}; give \"tetgen\" or \"gmsh\"", stage="fill")
    vertices, tetrahedra, regions = [np.array(result.vertices)], [], []
    count = len(result.vertices)
    for part in parts_of(result):
        of_result, shells = _own_vertices(part)
        points, corners = _filled(result.vertices[of_result], shells, part, mesher, quality)
        numbers = np.concatenate([of_result, np.arange(count, count + len(points) - len(of_result))])
        vertices.append(points[len(of_result):])
        count += len(points) - len(of_result)
        tetrahedra.append(numbers[corners].astype(np.int32))
        regions.append(np.full(len(corners), part.label, np.int32))
    return Filled(np.concatenate(vertices), np.concatenate(tetrahedra), np.concatenate(regions), result.region_names)


def _own_vertices(part: Part) -> tuple[Array, list[Array]]:
    import numpy as np

    of_result = np.unique(np.concatenate(part.shells))
    return of_result, [np.searchsorted(of_result, shell) for shell in part.shells]


def _filled(vertices: Array, shells: list[Array], part: Part, mesher: str, quality: float) -> tuple[Array, Array]:
    """Points, of which the first are the vertices, and tetrahedra of positive volume."""
    import numpy as np

    try:
        points, corners = MESHERS[mesher](vertices, shells, quality)
    except Error:
        raise
    except Exception as error:  # whatever the program raises
        raise _refusal(part, mesher, words_of(error), vertices, shells) from error
    if not np.array_equal(points[:len(vertices)], vertices):
        raise _refusal(part, mesher, "it changed the surface", vertices, shells)
    volumes = _volumes(points, corners)
    corners = np.where((volumes < 0)[:, None], corners[:, [1, 0, 2, 3]], corners)
    asked = sum(volume_of(vertices, shell) for shell in shells)
    if not FILLED * asked <= abs(volumes).sum() <= asked / FILLED:
        raise _refusal(part, mesher, f"it filled {100 * abs(volumes).sum() / asked:.1f} % of it", vertices, shells)
    return points, corners


def _volumes(points: Array, corners: Array) -> Array:
    import numpy as np

    a, b, c, d = (points[corners[:, i]] for i in range(4))
    return np.asarray(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6)


def _refusal(part: Part, mesher: str, words: str, vertices: Array, shells: list[Array]) -> Error:
    """With the place where the surface is hardest to fill."""
    import numpy as np

    faces = np.concatenate(shells)
    angle, at = _least_dihedral(vertices, faces)
    return Error(f"{mesher} does not fill {part.name}: {words}; its faces meet at {angle:.2g} degrees near "
                 f"{at[0]:g} {at[1]:g} {at[2]:g}: more vertices, or another mesher, may help", stage="fill")


def _least_dihedral(vertices: Array, faces: Array) -> tuple[float, Array]:
    """The smallest angle between two faces at an edge, on the inside, in degrees, and the middle of the edge."""
    import numpy as np

    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    opposite = np.concatenate([faces[:, 2], faces[:, 0], faces[:, 1]])
    of_face = np.tile(np.arange(len(faces)), 3)
    keys = np.sort(ends, axis=1)
    order = np.lexsort((keys[:, 1], keys[:, 0]))
    same = np.flatnonzero((keys[order][1:] == keys[order][:-1]).all(axis=1))
    first, second = order[same], order[same + 1]
    cosine = np.einsum("ij,ij->i", normals[of_face[first]], normals[of_face[second]]).clip(-1, 1)
    above = np.einsum("ij,ij->i", normals[of_face[first]], vertices[opposite[second]] - vertices[ends[first, 0]]) > 0
    angle = np.degrees(np.pi - np.arccos(cosine))
    angle[above] = 360 - angle[above]
    least = int(angle.argmin())
    return float(angle[least]), vertices[ends[first[least]]].mean(axis=0)
