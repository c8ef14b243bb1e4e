"""What a run made."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

from . import _isoshell
from ._errors import Error, warn
from ._exchange import format_of, to_package
from ._inputs import Mesh, counts_text, regions_in
from ._keywords import text_of
from ._labels import label_of
from ._level_set import LevelSet
from ._paths import path_text
from ._usd import Origin, is_usd

if TYPE_CHECKING:
    import meshio  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import numpy as np
    import pyvista  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import torch  # type: ignore[import-not-found, import-untyped, unused-ignore]
    import trimesh  # type: ignore[import-not-found, import-untyped, unused-ignore]

    from ._fill import Filled
    from ._keywords import Keywords

    Floats = np.ndarray[Any, np.dtype[np.float64]]
    Ints = np.ndarray[Any, np.dtype[np.int32]]
    Array = np.ndarray[Any, np.dtype[Any]]


class Result:
    """An isotropic triangle mesh, and all that is known of its run.

    Attributes:
        origin: what the scene that it comes from says of axes, units and materials, otherwise None: see isoshell.usd.
        material: what a mesh of trimesh that it comes from shows its texture coordinates with, otherwise None.
        frame: the number of its frame, or of a stage its time code; None where it is no frame of a sequence.
    """

    origin: Optional[Origin]
    frame: Optional[Union[int, float]]

    def __init__(self, made: _isoshell.RunResult, source: Optional[_isoshell.Source] = None,
                 reading: Optional[Keywords] = None, origin: Optional[Origin] = None,
                 volumes: Sequence[str] = (), material: Any = None) -> None:
        self._made = made
        self._source = source  # of a file; what memory has is not kept
        self._reading = reading or []  # the options that decide how it is read
        self.origin = origin
        self.material = material
        self.frame = None
        self._volumes = list(volumes)
        self._report: Optional[dict[str, Any]] = None
        self._attributes: Optional[list[tuple[str, str, Array, list[str]]]] = None
        self._level_set: Optional[LevelSet] = None

    @property
    def vertices(self) -> Floats:
        """(K, 3) float64, world units: a read-only view of the result's own memory, which it keeps alive."""
        return self._made.vertices

    @property
    def faces(self) -> Ints:
        """(M, 3) int32, counter-clockwise seen from outside: a read-only view, as vertices is."""
        return self._made.faces

    @property
    def attributes(self) -> dict[str, Array]:
        """What the source has beside its positions, found for the result; by name, of the type that it had there.

        (K, ...) of vertices, (M, ...) of faces, (M, 3, ...) of the corners of faces: see domains. "gap" is 1 where the
        source has no surface. A frame that follows another has "born", 1 where a vertex is not the one that had its
        number, and "vx", "vy" and "vz", its motion since then in world units. Values of grids have their names, vectors
        with .0, .1 and .2 behind them, and "Cd" is "color". A name that attributes of two domains
        have is, for the second, "name:domain".
        """
        return {name: values for name, _, values, _ in self._named_attributes()}

    @property
    def domains(self) -> dict[str, str]:
        """Of each attribute what has a value of its own: "vertex", "face" or "corner"."""
        return {name: domain for name, domain, _, _ in self._named_attributes()}

    @property
    def labels(self) -> dict[str, list[str]]:
        """Of the attributes whose values are numbers of names (-1: none), such as material and group: the names."""
        return {name: labels for name, _, _, labels in self._named_attributes() if labels}

    def _vectors_of_grids(self) -> list[str]:
        """The names of those attributes that are vectors of grids, each without its .0, .1 and .2."""
        of_grids = [grid["attributes"] for grid in self.report["attributes"]["grids"]]
        return [names[0].removesuffix(".0") for names in of_grids if len(names) == 3]

    @property
    def features(self) -> dict[str, Array]:
        """The patches and curves of the source that the result has; int32, empty where none were kept.

        patch (M,): of faces. curve_edges (E, 2): vertices of the edges on curves. curve (E,): the number of their
        curve. corners (C,): vertices where curves end or turn sharply.
        """
        return self._made.features

    @property
    def regions(self) -> dict[str, Any]:
        """The regions of the source that faces part, where it has any.

        labels (M, 2), int32: of each face the region behind it and the one that its normal points into, twice the same
        where that is what it lies in; (0, 2) where there are no regions. background: the label of what is no region.
        names: a dict from labels to names.
        """
        return self._made.regions

    @property
    def region_names(self) -> dict[int, str]:
        """What regions are called, by label; without those that have no name."""
        names: dict[int, str] = self._made.regions["names"]
        return names

    def region(self, label: int) -> Mesh:
        """One region by itself, a closed mesh that faces outward, with the attributes of its vertices and faces.

        Sheets that lie in it are left out. Its vertices are where the result has them; a vertex in which the region
        touches itself is there once for each sheet of faces. What is counted and measured of regions, and whether each
        is closed, is report["regions"].

        Raises:
            Error: of code USAGE for the background and for a label that no face has.
        """
        vertices, faces, attributes = self._made.region(label_of("label", label))
        of: dict[str, dict[str, Any]] = {"vertex": {}, "face": {}, "corner": {}}
        for name, domain, values, _ in attributes:
            of[domain][name] = values
        mesh = Mesh(vertices, faces, of_vertices=of["vertex"], of_faces=of["face"], of_corners=of["corner"],
                    labels={name: labels for name, _, _, labels in attributes if labels})
        mesh.name = self.region_names.get(label, f"region {label}")
        return mesh

    @property
    def report(self) -> dict[str, Any]:
        """What the command's --stats writes: topology, quality, features, times, warnings and more.

        Distances from the source, normals and digests are in it after remesh(..., stats=True).
        """
        if self._report is None:
            self._report = json.loads(self._made.statistics)
        assert self._report is not None
        return self._report

    @property
    def level_set(self) -> Optional[LevelSet]:
        """Signed distances, after remesh(..., save_level_set=True); otherwise None.

        They are around the surface of the source, as isoshell.level_set() makes them without a mesh, or with
        level_set_of="result" around the result. A result that is pickled loses it; it can be pickled by itself.
        """
        if self._level_set is None and self._made.level_set is not None:
            self._level_set = LevelSet(self._made.level_set)
        return self._level_set

    @property
    def digest(self) -> str:
        """Sixteen hexadecimal digits: the same for the same vertices and faces."""
        return self._made.digest

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False,
             recenter: Union[str, Sequence[float], None] = None) -> None:
        """Write the mesh with its attributes, as far as the format that the path's ending names has them.

        Args:
            path: file.
            overwrite: replace a file that is there.
            recenter: three numbers that are subtracted from what is written, or "auto", which takes round ones near the
                middle of the mesh. A RunWarning names them. For formats whose numbers are too coarse far from the
                origin, as STL.

        A stage of USD (.usda, .usdc, .usd, .usdz; needs usd-core) also names the stage files that the run saved, but
        in packages: see isoshell.usd.write, which takes more. Formats of other packages (.vtk .vtp .vtu .msh .med .xdmf
        .xmf .inp .3mf) need those; what they do not hold is warned of.

        Raises:
            Error: of code UNWRITABLE_OUTPUT when it cannot be written, or is there and overwrite is not True, or the
                format's numbers do not hold the triangles; of code USAGE for an ending that names no format.
        """
        if is_usd(path):
            from . import usd

            package = path_text(path).lower().endswith(".usdz")
            usd.write(path, self, volumes=[] if package else self._volumes, overwrite=overwrite, recenter=recenter)
        elif format_of(path) is not None:
            from ._exchange import _files

            if recenter is not None:
                raise Error(f"recenter: not for {path_text(path)}, whose format is another package's", stage="options")
            _files.write(path_text(path), self, overwrite)
        else:
            for text in self._made.save(path_text(path), overwrite, text_of("recenter", recenter)):
                warn(text)
            for lost in self._made.not_held(path_text(path).lower()):
                warn(f"{path_text(path)}: without {lost}")

    def export(self, path: str | os.PathLike[str], *, overwrite: bool = False,
               recenter: Union[str, Sequence[float], None] = None) -> None:
        """The same as save()."""
        self.save(path, overwrite=overwrite, recenter=recenter)

    def to_trimesh(self) -> trimesh.Trimesh:
        """A trimesh.Trimesh with copies of all that there is: colours, texture coordinates, normals, attributes of
        vertices and faces, of regions region_inside and region_outside of faces. Needs trimesh.

        trimesh shows colours or a texture. For a texture it has coordinates by vertex: where these jump, along seams, and
        normals on creases, vertices are there once for each side, at the same place. Beside colours both are
        face_attributes, of the shape (M, 3, ...). Names of labels and regions are metadata["isoshell"].
        """
        made: trimesh.Trimesh = to_package("_trimesh", self)
        return made

    def to_pyvista(self) -> pyvista.PolyData:
        """A pyvista.PolyData with the same: point_data, cell_data, active texture coordinates "uv" and normals
        "normal", for which vertices are there once for each side of a seam or crease; names in field_data. Needs pyvista."""
        made: pyvista.PolyData = to_package("_pyvista", self)
        return made

    def to_meshio(self) -> meshio.Mesh:
        """A meshio.Mesh with the same, in the same way: point_data and cell_data; names in field_data, with their number and 2 for a
        label of faces, or 3 for a region. Needs meshio."""
        made: meshio.Mesh = to_package("_meshio", self)
        return made

    def fill(self, mesher: str = "tetgen", quality: float = 1.4) -> Filled:
        """Tetrahedra in every region, or in the closed mesh, whose outer triangles are those of the result, bit for bit.

        Each connected piece of a region is filled by itself. Needs tetgen or gmsh, both on PyPI, under their own
        licenses.

        Args:
            mesher: "tetgen", whose tetrahedra grow inwards as far as `quality` lets them, or "gmsh", whose edges are as
                long as those of the surface.
            quality: for TetGen, how many times as long as its shortest edge the radius of a tetrahedron's circumsphere
                may be; near the surface it may be more.

        Raises:
            Error: of code USAGE for an open mesh, and for a piece that the program does not fill to 99.9 % or whose
                surface it changes, with the place where its faces meet at the smallest angle.
        """
        from ._fill import fill

        return fill(self, mesher, quality)

    def to_torch(self, device: Optional[Any] = None) -> tuple[torch.Tensor, torch.Tensor]:
        """Vertices (K, 3) float64 and faces (M, 3) int64 as tensors of torch, which own their memory. Needs torch.

        Args:
            device: whatever torch takes; without it the device that the run was on, the host's memory where that was
                the CPU. The result is in the host's memory, and is copied from there once.
        """
        import torch

        if device is None:
            on_cuda = self.report["device"] == "cuda"
            device = f"cuda:{self.report['device_details']['number']}" if on_cuda else "cpu"
        return torch.tensor(self.vertices, device=device), torch.tensor(self.faces, dtype=torch.int64, device=device)

    def __repr__(self) -> str:
        counts = counts_text(self.vertices, self.faces, [*self.attributes], regions_in(self.regions))
        return f"<isoshell.Result: {counts}>"

    def __getstate__(self) -> dict[str, Any]:
        """Without the arrays of attributes, which are views of the mesh, and the level set."""
        return {**self.__dict__, "_attributes": None, "_level_set": None}

    def _named_attributes(self) -> list[tuple[str, str, Array, list[str]]]:
        if self._attributes is None:
            self._attributes = []
            names = set()
            for name, domain, values, labels in self._made.attributes:
                key = f"{name}:{domain}" if name in names else name
                names.add(key)
                self._attributes.append((key, domain, values, labels))
        return self._attributes


def checked(result: Result) -> Result:
    """Raises Error of code GATE_FAILED for a result that misses a requirement."""
    missed = result._made.missed_gates
    if missed:
        text = "; ".join(_isoshell.in_keywords(gate) for gate in missed)
        raise Error(f"{text}; the error's result has the mesh", _isoshell.ErrorCode.GATE_FAILED, "gates", result)
    return result
