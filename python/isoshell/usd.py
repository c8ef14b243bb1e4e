"""Scenes of USD: meshes in, and results with their volumes out. Needs usd-core: pip install 'isoshell[usd]'.

    result = isoshell.remesh("scene.usda")                 # every mesh that is seen
    result = isoshell.remesh("scene.usda:/World/Mesh")     # that prim, and what is below it
    result = isoshell.remesh(isoshell.usd.read("scene.usda", "/World/Mesh", time=24))
    isoshell.remesh_sequence("scene.usda:/World/Mesh", output="out.usdc")    # all of its time samples
    result.save("out.usda")                                # or .usdc, or .usdz
    isoshell.usd.write("out.usda", result, volumes=["out.shell.vdb", "out.voronoi.vdb"])

Points are in the stage's world: transforms are applied, in double precision, and nothing else is done to them. The up
axis and the unit are passed on.
"""

from __future__ import annotations

import os
from typing import Optional, Sequence

from ._inputs import Mesh
from ._usd import Origin, is_usd
from ._usd._read import PURPOSES, Scene
from ._usd._write import write

__all__ = ["Origin", "is_usd", "read", "write"]


def read(path: str | os.PathLike[str], prim: Optional[str] = None, *, time: Optional[float] = None,
         purposes: Sequence[str] = PURPOSES) -> Mesh:
    """The meshes of a stage as one source, with instances and references resolved.

    Polygons are split as those of any other file, faces of holeIndices left out, left-handed and mirrored meshes turned
    so that their outside stays outside. Subdivision surfaces are read as their cages, and meshes that move
    with a skeleton or blend shapes as they rest, with a warning. Primvars are attributes:
    displayColor and displayOpacity are color, the first set of texture coordinates uv, normals normal, bound materials
    and those of subsets material; values of two to four numbers come apart into name.0, name.1 and so on.

    Args:
        path: a file, perhaps with a prim: FILE.usda:/World/Mesh.
        prim: what to read: a mesh, seen or not, or the meshes below; all of the stage without it.
        time: time code; without it the one that the stage starts with.
        purposes: of the meshes to read where several are.

    Raises:
        Error: of code UNREADABLE_INPUT for a file that cannot be read or contradicts itself, NOTHING_TO_MESH without a
            mesh that is seen, USAGE for a prim that is not there and without usd-core.
    """
    return Scene(path, prim, purposes).mesh_at(time)
