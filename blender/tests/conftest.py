"""The extension, installed as Blender does it, and an empty scene for each test."""

import os
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.append(str(Path(__file__).parents[2] / "python/tests"))
from left_out import pytest_sessionfinish, pytest_terminal_summary  # noqa: E402, F401, hooks


@pytest.fixture(scope="session")
def extension():
    """The package of the extension; installed from ISOSHELL_EXTENSION, a zip file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.extensions.package_install_files(filepath=os.environ["ISOSHELL_EXTENSION"], repo="user_default",
                                             enable_on_install=True)
    return sys.modules["bl_ext.user_default.isoshell"]


@pytest.fixture(autouse=True)
def scene(extension):
    for blocks in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.volumes):
        for block in list(blocks):
            blocks.remove(block)
    return bpy.context.scene


def rows(collection, member, width, kind=np.float32):
    values = np.empty((len(collection), width), kind)
    collection.foreach_get(member, values.reshape(-1))
    return values


def triangles_of(obj):
    """Vertices in the world and faces of an object whose faces are all triangles."""
    mesh = obj.data
    assert all(len(polygon.vertices) == 3 for polygon in mesh.polygons)
    matrix = np.array(obj.matrix_world)
    vertices = rows(mesh.vertices, "co", 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
    return vertices, rows(mesh.polygons, "vertices", 3, np.int32)


def assert_closed_manifold(faces, vertex_count, genus=0):
    """Every edge has a face on either side that runs along it the other way, and Euler's formula holds."""
    directed = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    keys = directed @ (vertex_count, 1)
    assert len(np.unique(keys)) == len(keys)
    assert np.isin(directed[:, ::-1] @ (vertex_count, 1), keys).all()
    assert len(np.unique(faces)) == vertex_count
    assert vertex_count - len(keys) // 2 + len(faces) == 2 - 2 * genus


def edge_lengths(vertices, faces):
    """Lengths and middles of the edges."""
    ends = vertices[np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), 1), axis=0)]
    return np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1), ends.mean(1)


def signed_volume(vertices, faces):
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    return np.einsum("nj,nj->", a, np.cross(b, c)) / 6
