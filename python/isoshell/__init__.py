"""Isotropic triangle meshes from any surface."""

import json
import os

from . import _isoshell


class Result:
    """A mesh and the report of its run."""

    def __init__(self, made):
        self._made = made
        self.report = json.loads(made._report)

    @property
    def vertices(self):
        """(K, 3) float64, world units: a read-only view of the result's own memory."""
        return self._made.vertices

    @property
    def faces(self):
        """(M, 3) int32: a read-only view of the result's own memory."""
        return self._made.faces

    def save(self, path, overwrite=False):
        """Write the mesh; the name's ending says the format."""
        self._made.save(os.fspath(path), overwrite)


def remesh(path, **options):
    """Remesh a file that the command can read; options as in the command's JSON."""
    return Result(_isoshell.remesh_file(os.fspath(path), json.dumps(options)))
