# SPDX-License-Identifier: Apache-2.0
"""An object with a volume as what isoshell starts from."""

import os
import tempfile

import numpy as np

from .mesh_source import Refused, linear_of

FINER = 4  # times as many vertices has the mesh that is made first where the object's scale is not even


class TakenVolume:
    """A grid in a file that is there as long as this is, and the object's transform without its place."""

    def __init__(self, obj, depsgraph, grid_name):
        self.to_world = linear_of(obj)
        evaluated = obj.evaluated_get(depsgraph)
        grids = evaluated.data.grids
        if not grids.is_loaded and not grids.load():
            raise Refused(f"{obj.name}: {grids.error_message or 'its volume cannot be loaded'}")
        if not len(grids):
            raise Refused(f"{obj.name} has no grids")
        names = [grid.name for grid in grids]
        name = grid_name or names[min(max(grids.active_index, 0), len(names) - 1)]
        if name not in names:
            raise Refused(f"{obj.name} has no grid {name}; its grids are {', '.join(names)}")
        self._folder = tempfile.TemporaryDirectory()
        path = grids.frame_filepath
        if not path or obj.modifiers or not os.path.isfile(path):  # made by modifiers or nodes
            path = os.path.join(self._folder.name, "volume.vdb")
            if not grids.save(filepath=path):
                raise Refused(f"{obj.name}: its grids cannot be written to {path}")
        self.source = f"{path}:{name}"

    def remesh(self, options, context, isoshell):
        """Vertices in the object's space, and faces. The edges are even in the world."""
        scales = np.linalg.svd(self.to_world, compute_uv=False)
        back = np.linalg.inv(self.to_world).T
        if scales[0] - scales[-1] <= 1e-6 * scales[0]:
            if "edge_length" in options:
                options = options | {"edge_length": options["edge_length"] / scales[0]}
            result = isoshell.remesh(self.source, context=context, **options)
            return result, result.vertices, result.faces
        fine = {name: value for name, value in options.items() if name not in ("vertices", "edge_length")}
        fine |= ({"vertices": FINER * options["vertices"]} if "vertices" in options else
                 {"edge_length": options["edge_length"] / scales[0] / 2})
        first = isoshell.remesh(self.source, context=context, **fine)
        flips = np.linalg.det(self.to_world) < 0
        faces = first.faces[:, ::-1] if flips else first.faces
        options = {name: value for name, value in options.items() if name != "iso"}
        result = isoshell.remesh((first.vertices @ self.to_world.T, faces), context=context, **options)
        return result, result.vertices @ back, result.faces[:, ::-1] if flips else result.faces
