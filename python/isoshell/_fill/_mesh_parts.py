"""What other programs fill one piece of a region with: TetGen and Gmsh, both from PyPI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

from .._exchange import package

if TYPE_CHECKING:
    import numpy as np

    Array = np.ndarray[Any, np.dtype[Any]]


def by_tetgen(vertices: Array, shells: Sequence[Array], quality: float) -> tuple[Array, Array]:
    """Points, of which the first are the vertices, and tetrahedra; those of hollows among them.

    Raises:
        RuntimeError: for surfaces that it does not take.
    """
    import numpy as np

    tetgen: Any = package("tetgen", "mesher='tetgen'")
    made = tetgen.TetGen(vertices, np.concatenate(shells).astype(np.int32))
    points, tetrahedra, numbers, *_ = made.tetrahedralize(minratio=quality, nobisect=True, regionattrib=True)
    return np.asarray(points), np.asarray(tetrahedra)[_within(tetrahedra, np.ravel(numbers), shells)]


def _within(tetrahedra: Array, numbers: Array, shells: Sequence[Array]) -> Array:
    """Of tetrahedra with the numbers of the spaces that they are in, those of the space within the outer shell: one of
    that has a face of the shell, and its fourth corner behind it."""
    import numpy as np

    if len(shells) == 1:
        return np.ones(len(tetrahedra), bool)
    faces = {tuple(sorted(face)) for face in shells[0].tolist()}
    for sides in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
        for number, corners in zip(numbers, np.sort(tetrahedra[:, sides], axis=1).tolist()):
            if tuple(corners) in faces:
                return np.asarray(numbers == number)
    return np.zeros(len(tetrahedra), bool)


def by_gmsh(vertices: Array, shells: Sequence[Array], quality: float) -> tuple[Array, Array]:
    """The same; its elements are as long as the edges of the surface, and `quality` says nothing to it.

    Raises:
        Exception: for surfaces that it does not take.
    """
    import numpy as np

    gmsh: Any = package("gmsh", "mesher='gmsh'")
    was_running = gmsh.isInitialized()
    if not was_running:
        gmsh.initialize(interruptible=False)
    # By default faces that meet at less than .1 degrees are refused as ones that overlap, which a result has none of.
    options = {"General.Terminal": 0, "Mesh.AngleToleranceFacetOverlap": 0}
    before = {name: gmsh.option.getNumber(name) for name in options}
    for name, value in options.items():
        gmsh.option.setNumber(name, value)
    gmsh.model.add("isoshell fill")
    try:
        surfaces = [gmsh.model.addDiscreteEntity(2) for _ in shells]
        gmsh.model.mesh.addNodes(2, surfaces[0], np.arange(len(vertices)) + 1, vertices.ravel())
        for surface, faces in zip(surfaces, shells):
            gmsh.model.mesh.addElementsByType(surface, 2, [], faces.ravel() + 1)
        gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop([surface]) for surface in surfaces])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(3)
        tags, places, _ = gmsh.model.mesh.getNodes()
        tetrahedra = gmsh.model.mesh.getElementsByType(4)[1].reshape(-1, 4)
    finally:
        gmsh.model.remove()
        for name, value in before.items():
            gmsh.option.setNumber(name, value)
        if not was_running:
            gmsh.finalize()
    order = np.argsort(tags)
    if len(tetrahedra) == 0:
        raise RuntimeError("it made no tetrahedra")
    return places.reshape(-1, 3)[order], np.searchsorted(tags[order], tetrahedra)
