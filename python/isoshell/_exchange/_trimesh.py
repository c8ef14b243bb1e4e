"""Meshes, scenes and point clouds of trimesh; and results as meshes of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .._errors import Error
from .._inputs import Mesh, Points
from .._sources import named_of
from . import package
from ._give import given_of
from ._take import Taker, joined

if TYPE_CHECKING:
    import trimesh  # type: ignore[import-not-found, import-untyped, unused-ignore]

    from .._result import Result

NOTES = "isoshell"  # the key of a mesh's metadata


def taken(given: Any, options: dict[str, Any]) -> Any:
    """A source of it.

    Raises:
        Error: of code USAGE for what has no surface.
    """
    trimesh = package("trimesh", "an object of trimesh")
    if isinstance(given, trimesh.PointCloud):
        return Points(given.vertices)
    if isinstance(given, trimesh.Scene):
        return _taken_scene(trimesh, given)
    if isinstance(given, trimesh.Trimesh):
        return _taken_mesh(trimesh, given)
    raise Error(f"source is a {type(given).__name__} of trimesh, which has no faces; give a Trimesh, Scene or PointCloud")


def _taken_scene(trimesh: Any, scene: Any) -> Mesh:
    """The meshes of a scene where their nodes put them."""
    meshes = []
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        geometry = scene.geometry[name]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            placed = geometry.copy(include_cache=True)
            meshes.append(_taken_mesh(trimesh, placed.apply_transform(matrix)))
    if not meshes:
        raise Error("source is a Scene of trimesh without faces; give one that has a mesh")
    return joined("Scene", meshes)


def _taken_mesh(trimesh: Any, mesh: Any) -> Mesh:
    taker = Taker("Trimesh", mesh.vertices, mesh.faces)
    visual = mesh.visual
    if visual.kind == "texture":
        if visual.uv is not None:
            taker.add("uv", "vertex", visual.uv)
        taker.mesh.material = visual.material
    elif visual.defined:
        kind = "face" if visual.kind == "face" else "vertex"
        taker.add("color", kind, visual.face_colors if kind == "face" else visual.vertex_colors)
    for name, values in mesh.vertex_attributes.items():
        taker.add(name, "vertex", values)
    for name, values in mesh.face_attributes.items():
        taker.add(name, "face", values)
    if _has_own_normals(trimesh, mesh):
        taker.add("normal", "vertex", mesh.vertex_normals)
    taker.add_names(mesh.metadata.get(NOTES, {}))
    return taker.mesh


def _has_own_normals(trimesh: Any, mesh: Any) -> bool:
    """Whether somebody gave them: what trimesh makes of the faces says nothing more than these."""
    import numpy as np

    if "vertex_normals" not in mesh._cache:
        return False
    alone = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    return not np.allclose(alone.vertex_normals, mesh.vertex_normals, atol=1e-6)


def given(made: Result | Mesh) -> trimesh.Trimesh:
    """A Trimesh with copies of all that there is. It shows colours or a texture, and only that parts vertices."""
    import numpy as np

    library = package("trimesh", "to_trimesh()")
    has_colors = any(name == "color" for name, *_ in named_of(made))
    mesh = given_of(made, splits=not has_colors)
    of_vertices, of_faces = dict(mesh.of_vertices), dict(mesh.of_faces)
    options: dict[str, Any] = {}
    if "color" in of_vertices:
        options["vertex_colors"] = _bytes(of_vertices.pop("color"))
    elif "color" in of_faces:
        options["face_colors"] = _bytes(of_faces.pop("color"))
    elif "uv" in of_vertices:
        uv = np.array(of_vertices.pop("uv"), np.float64)
        options["visual"] = library.visual.TextureVisuals(uv=uv, material=made.material)
    normals = of_vertices.get("normal")
    if normals is not None and np.isfinite(normals).all():
        options["vertex_normals"] = of_vertices.pop("normal")
    metadata = {NOTES: mesh.notes} if mesh.notes else None
    shown: trimesh.Trimesh = library.Trimesh(mesh.vertices, mesh.faces, vertex_attributes=of_vertices,
                                             face_attributes=of_faces, metadata=metadata, process=False, **options)
    return shown


def _bytes(colors: Any) -> Any:
    """As trimesh has colours: of 8 bits."""
    import numpy as np

    if colors.dtype == np.uint8:
        return colors
    most = 1 if colors.dtype.kind == "f" else np.iinfo(colors.dtype).max
    return np.rint(np.nan_to_num(colors.astype(np.float64)) / most * 255).clip(0, 255).astype(np.uint8)


def check(path: str) -> Any:
    """The package, with those that it needs for such a file."""
    library = package("trimesh", f"{path}: this format")
    package("networkx", f"{path}: this format")
    package("lxml", f"{path}: this format")
    return library


def read(path: str, options: dict[str, Any]) -> Any:
    """What a file has."""
    return taken(check(path).load_scene(path), options)


def write(made: Result | Mesh, path: str) -> list[str]:
    """Returns what the file does not hold."""
    library, mesh = check(path), given_of(made)
    scene = library.Scene([library.Trimesh(made.vertices, made.faces, process=False)])
    scene.export(path)
    return [*mesh.of_vertices, *mesh.of_faces]


def files_beside(path: str) -> list[str]:
    """Other files that hold a part of that one: none."""
    return []
