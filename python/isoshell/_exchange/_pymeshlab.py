"""Meshes of PyMeshLab, and mesh sets, of which the current mesh is taken."""

from __future__ import annotations

from typing import Any

from .._errors import Error
from .._inputs import Points
from . import package
from ._take import Taker


def taken(given: Any, options: dict[str, Any]) -> Any:
    """A source of it."""
    library = package("pymeshlab", "an object of PyMeshLab")
    mesh = given.current_mesh() if isinstance(given, library.MeshSet) else given
    if not isinstance(mesh, library.Mesh):
        raise Error(f"source is a {type(given).__name__} of PyMeshLab; give a Mesh or a MeshSet")
    vertices = mesh.transformed_vertex_matrix()
    if mesh.face_number() == 0:
        return Points(vertices)
    taker = Taker("Mesh", vertices, mesh.face_matrix())
    if mesh.has_vertex_color():
        taker.add("color", "vertex", mesh.vertex_color_matrix())
    elif mesh.has_face_color():
        taker.add("color", "face", mesh.face_color_matrix())
    if mesh.has_vertex_scalar():
        taker.add("scalar", "vertex", mesh.vertex_scalar_array())
    if mesh.has_face_scalar():
        taker.add("scalar", "face", mesh.face_scalar_array())
    if mesh.has_wedge_tex_coord():
        taker.add("uv", "corner", mesh.wedge_tex_coord_matrix())
    elif mesh.has_vertex_tex_coord():
        taker.add("uv", "vertex", mesh.vertex_tex_coord_matrix())
    return taker.mesh
