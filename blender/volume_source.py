# SPDX-License-Identifier: Apache-2.0
"""An object with a volume as what isoshell starts from."""

import functools
import os
import tempfile

import numpy as np

from .mesh_result import in_object
from .mesh_source import Refused, linear_of

OF_LABELS = {"INT", "INT64"}
OF_THE_GRID = {"iso", "grids", "background", "smallest_island", "smoothing"}  # options that a mesh of it has no use for
FINER = 4  # times as many vertices has the mesh that is made first where the object's scale is not even


def _name_of(grids, wanted):
    return wanted or grids[min(max(grids.active_index, 0), len(grids) - 1)].name


def _classes_of(path):
    """Of a file's grids by name: "level set", "fog volume" and so on; none where only reading it will say."""
    try:
        status = os.stat(path)
    except OSError:
        return {}
    return _classes_of_state(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=16)  # the panel asks whenever it is drawn
def _classes_of_state(path, _time, _size):
    from isoshell import Error
    from isoshell._vdb_header import grids_of

    try:
        return {grid.name: grid.grid_class for grid in reversed(grids_of(path))}  # the first one of a name
    except Error:  # the run refuses it with the reason, if it cannot read it either
        return {}


def grid_of(obj, wanted):
    """Name and class of the grid that would be meshed; None where they are not known before modifiers are done."""
    grids = obj.data.grids
    if obj.modifiers or not (grids.is_loaded or grids.load()) or not len(grids):
        return None
    name = _name_of(grids, wanted)
    classes = _classes_of(grids.frame_filepath)
    return (name, classes[name]) if name in classes else None


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
        name = _name_of(grids, grid_name)
        if name not in names:
            raise Refused(f"{obj.name} has no grid {name}; its grids are {', '.join(names)}")
        self.name = name
        self.is_of_labels = grids[names.index(name)].data_type in OF_LABELS
        self._folder = tempfile.TemporaryDirectory()
        path = grids.frame_filepath
        if not path or obj.modifiers or not os.path.isfile(path):  # made by modifiers or nodes
            path = os.path.join(self._folder.name, "volume.vdb")
            if not grids.save(filepath=path):
                raise Refused(f"{obj.name}: its grids cannot be written to {path}")
        self.source = f"{path}:{name}"
        self.grid_class = _classes_of(path).get(name, "unknown")

    def remesh(self, options, context, isoshell):
        """The result, what its vertices are multiplied by to be in the object's space, and which of its attributes are
        values of which grids. The edges are even in the world."""
        scales = np.linalg.svd(self.to_world, compute_uv=False)
        back = np.linalg.inv(self.to_world).T
        if scales[0] - scales[-1] <= 1e-6 * scales[0]:
            if "edge_length" in options:
                options = options | {"edge_length": options["edge_length"] / scales[0]}
            result = isoshell.remesh(self.source, context=context, **options)
            return result, np.eye(3), result.report["attributes"]["grids"]
        fine = {name: value for name, value in options.items() if name not in ("vertices", "edge_length")}
        fine |= ({"vertices": FINER * options["vertices"]} if "vertices" in options else
                 {"edge_length": options["edge_length"] / scales[0] / 2})
        first = isoshell.remesh(self.source, context=context, **fine)
        vertices, faces = in_object(first.vertices, first.faces, self.to_world.T)
        options = {name: value for name, value in options.items() if name not in OF_THE_GRID}
        grids = first.report["attributes"]["grids"]
        values = {name: first.attributes[name] for grid in grids for name in grid["attributes"]}
        source = isoshell.Mesh(vertices, faces, of_vertices=values)
        if len(first.regions["labels"]):
            source = os.path.join(self._folder.name, "walls.ply")
            _write_walls(source, vertices, faces, first.regions)
        return isoshell.remesh(source, context=context, **options), back, grids


def _write_walls(path, vertices, faces, regions):
    """As isoshell writes and reads regions. What is in memory has them only where it is a result as it came."""
    names = [f"comment region {label} {name}" for label, name in regions["names"].items()]
    header = ["ply", "format binary_little_endian 1.0", *names, f"comment region_background {regions['background']}",
              f"element vertex {len(vertices)}", *(f"property double {axis}" for axis in "xyz"),
              f"element face {len(faces)}", "property list uchar int vertex_indices", "property int region_inside",
              "property int region_outside", "end_header", ""]
    rows = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3), ("regions", "<i4", 2)])
    rows["count"], rows["corners"], rows["regions"] = 3, faces, regions["labels"]
    with open(path, "wb") as file:
        file.write("\n".join(header).encode() + np.ascontiguousarray(vertices, "<f8").tobytes() + rows.tobytes())
