"""Certificates of any mesh."""

from __future__ import annotations

import json
import os
from typing import Any, Optional, Sequence, Union

from . import _isoshell
from ._context import Context
from ._errors import Error
from ._keywords import Keywords
from ._remesh import keywords_for, listener, settle
from ._sources import SourceLike, opened, source_of, with_faces

AS_IT_IS = ("features", "off")  # creases are for who remeshes


def mesh_info(mesh: SourceLike, *faces: Any, ref: Optional[SourceLike] = None,
              require: Optional[Union[str, Sequence[str]]] = None, input_format: Optional[str] = None,
              ref_format: Optional[str] = None, context: Optional[Context] = None, threads: Optional[int] = None,
              max_memory: Optional[Union[int, str]] = None) -> dict[str, Any]:
    """Count and measure a mesh as it is, as the command vdb_meshinfo does: nothing is repaired, welded or dropped.

    Args:
        mesh: a mesh as remesh() takes it: a path, (vertices, faces), an object that has both, isoshell.Mesh, a Result.
        faces: mesh_info(V, F) is mesh_info((V, F)).
        ref: also measure distances and deviations of normals from this surface, both ways: any source of remesh(). Of
            points the distances from each of them to the mesh are measured, and nothing the other way.
        require: closed, manifold, no-self-intersections, genus=G, components=N, boundary-loops=N, regions (each closed,
            with shared walls), min-angle=DEG, and with ref max-deviation=W (world units) and normal-deviation=DEG; a
            list, or one text with commas.
        input_format: format of a mesh in a file: obj, ply, stl, off, glb or gltf; by its name without it.
        ref_format: format of a ref in a file: one of those, or xyz, pcd, vdb or nvdb.
        context: where to run, and who hears of progress; otherwise threads and max_memory say it.
        threads: number of CPU threads; all without it. The numbers are the same for any.
        max_memory: refuse input that needs more, as "512M", "8G" or bytes; without it 80 % of what is free.

    Returns:
        What the command writes with --json: topology, regions (None of a mesh without), quality, edges, valence,
            distance (None without ref) and more.

    Raises:
        Error: GATE_FAILED when the mesh does not meet `require`: the error's info has what would have been returned.
            USAGE for what is no mesh, and others as remesh() raises them when it reads a source.
        KeyboardInterrupt: within .3 s of the key.
    """
    options: dict[str, Any] = {"require": require, "input_format": input_format, "threads": threads,
                               "max_memory": max_memory}
    if context is None:
        options["device"] = "cpu"
    place, progress = settle(context, options)
    mesh = opened(with_faces(mesh, faces), options)
    ref = opened(ref, {"input_format": ref_format})
    reference = None if ref is None else source_of(ref)
    text, missed = _isoshell.mesh_info(place, source_of(mesh), keywords_for(mesh, options), reference,
                                       _keywords_of_reference(ref, ref_format), progress, listener({}))
    info: dict[str, Any] = json.loads(text)
    if missed:
        told = "; ".join(_isoshell.in_keywords(gate) for gate in missed)
        raise Error(told, _isoshell.ErrorCode.GATE_FAILED, "gates", info=info)
    return info


def _keywords_of_reference(ref: Optional[SourceLike], ref_format: Optional[str]) -> Keywords:
    if ref_format is not None and not isinstance(ref, (str, os.PathLike)):
        raise Error("ref_format is for a ref in a file; leave it out")
    return [AS_IT_IS, *keywords_for(ref, {"input_format": ref_format})]
