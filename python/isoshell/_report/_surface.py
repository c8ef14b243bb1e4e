"""What is drawn of a mesh and counted on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Optional

import numpy as np

Array = np.ndarray[Any, Any]

QUALITY_OF_EQUILATERAL = 2 * np.sqrt(3.0)


@dataclass
class Surface:
    """A mesh whose vertices are joined where they are in the same place, with values of its vertices and faces."""

    vertices: Array  # (K, 3) float64, world units
    faces: Array  # (M, 3) int64
    of_vertices: Dict[str, Array] = field(default_factory=dict)
    of_faces: Dict[str, Array] = field(default_factory=dict)
    lines: Dict[str, Array] = field(default_factory=dict)  # by name (E, 2) vertices
    color: Optional[Array] = None  # of each face the number of a colour
    regions: Optional[Array] = None  # (M, 2) of each face the labels of the regions behind it and in front


def joined(vertices: Array, faces: Array, regions: Optional[Array] = None) -> Surface:
    """A surface as files have it, without faces that are no triangles then, and without vertices of no face."""
    finite = np.logical_and.reduce(np.isfinite(vertices), axis=1)
    _, first, number = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    drawn = finite[faces].all(axis=1)
    corners = first[number.reshape(-1)][faces[drawn]]
    whole = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2]) & (corners[:, 2] != corners[:, 0])
    used, numbers = np.unique(corners[whole], return_inverse=True)  # in the order of the file: neighbours are near
    surface = Surface(np.ascontiguousarray(vertices[used]), numbers.reshape(-1, 3).astype(np.int64))
    if regions is not None and len(regions):
        surface.regions = regions[drawn][whole]
    return surface


@dataclass
class Edges:
    """Every edge once: its vertices, the lesser first, and how many faces it has."""

    ends: Array  # (E, 2)
    faces: Array  # (E,)

    @staticmethod
    def of(surface: Surface) -> Edges:
        ends = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        count = len(surface.vertices)
        keys, faces = np.unique(ends[:, 0] * count + ends[:, 1], return_counts=True)
        return Edges(np.column_stack([keys // max(count, 1), keys % max(count, 1)]), faces)

    @staticmethod
    def sides(of_faces: Array, count: int, faces: Array) -> Array:
        """(N, 2): values of the two faces beside an edge, where they differ."""
        ends = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        keys, values = ends[:, 0] * count + ends[:, 1], np.repeat(of_faces, 3)
        order = np.argsort(keys, kind="stable")
        same = keys[order][1:] == keys[order][:-1]
        pairs = np.column_stack([values[order][:-1], values[order][1:]])[same]
        differing: Array = pairs[pairs[:, 0] != pairs[:, 1]]
        return differing

    def valence(self, count: int) -> Array:
        """Of each vertex its neighbours. On a border the number is what it would be inside: 4 there is 6."""
        valence = np.bincount(self.ends.ravel(), minlength=count)
        is_border = np.zeros(count, bool)
        is_border[self.ends[self.faces == 1]] = True
        return np.where(is_border & (valence > 0), valence + 2, valence)


def corner_vectors(surface: Surface) -> Array:
    """(M, 3, 3): from each corner of a face to the next."""
    at: Array = surface.vertices[surface.faces]
    vectors: Array = np.roll(at, -1, axis=1) - at
    return vectors


def face_quality(surface: Surface) -> Array:
    """Of each face 6 / sqrt(3) times area over half the circumference times the longest edge: 1 if equilateral."""
    sides = corner_vectors(surface)
    length = np.linalg.norm(sides, axis=2)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    below = length.sum(axis=1) / 2 * length.max(axis=1)
    quality: Array = QUALITY_OF_EQUILATERAL * np.divide(area, below, out=np.zeros(len(area)), where=below > 0)
    return quality


def angles_deg(surface: Surface) -> Array:
    """All angles of all faces that have an area."""
    sides = corner_vectors(surface)
    length = np.linalg.norm(sides, axis=2)
    sides, length = sides[(length > 0).all(axis=1)], length[(length > 0).all(axis=1)]
    cosine = -np.einsum("ijk,ijk->ij", sides, np.roll(sides, 1, axis=1)) / (length * np.roll(length, 1, axis=1))
    angles: Array = np.degrees(np.arccos(np.clip(cosine, -1, 1))).ravel()
    return angles


def edge_lengths(surface: Surface, edges: Edges) -> Array:
    lengths: Array = np.linalg.norm(surface.vertices[edges.ends[:, 0]] - surface.vertices[edges.ends[:, 1]], axis=1)
    return lengths


def groups(count: int, ends: Array) -> Array:
    """Of each of so many vertices the smallest that these edges connect it with."""
    group = np.arange(count)
    while len(ends):
        least = np.minimum(group[ends[:, 0]], group[ends[:, 1]])
        before = group.copy()
        np.minimum.at(group, group[ends[:, 0]], least)
        np.minimum.at(group, group[ends[:, 1]], least)
        while not np.array_equal(group, group[group]):
            group = group[group]
        if np.array_equal(before, group):
            break
    return group


def thinned(surface: Surface, most: int) -> Surface:
    """At most so many faces: vertices in one cell of a lattice become one, with the largest of their values.

    A face has the largest value of all that have a corner in one of its cells: none is lost with a face that vanishes.
    """
    if len(surface.faces) <= most:
        return surface
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    sides = corner_vectors(surface)
    area = float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)
    size = max(np.sqrt(3 * area / most), float((high - low).max()) / 2**20)  # there are some three faces a cell
    while True:
        made = _on_lattice(surface, low, size)
        if len(made.faces) <= most:
            return made
        size *= max(1.02, np.sqrt(len(made.faces) / most))


def _on_lattice(surface: Surface, low: Array, size: float) -> Surface:
    place = ((surface.vertices - low) / size).astype(np.int64)
    _, first, cell = np.unique(place @ np.array([1, 2**21, 2**42]), return_index=True, return_inverse=True)
    cell = cell.reshape(-1)
    count = np.bincount(cell)
    vertices = np.column_stack([np.bincount(cell, surface.vertices[:, i]) / count for i in range(3)])
    faces = cell[surface.faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    numbers = np.flatnonzero(whole)
    numbers = numbers[np.unique(turned[numbers], axis=0, return_index=True)[1]]
    corners = faces.ravel()
    of_faces = {name: _largest(np.repeat(values, 3), corners, len(first))[turned[numbers]].max(axis=1)
                for name, values in surface.of_faces.items()}
    of_vertices = {name: _largest(values, cell, len(first)) for name, values in surface.of_vertices.items()}
    lines = {name: _lines_between(cell, ends) for name, ends in surface.lines.items()}
    color = None if surface.color is None else surface.color[numbers]
    regions = None if surface.regions is None else surface.regions[numbers]
    return Surface(vertices, turned[numbers], of_vertices, of_faces, lines, color, regions)


def _largest(values: Array, group: Array, count: int) -> Array:
    """Of each of so many groups; values are 0 or more."""
    largest = np.zeros(count, values.dtype)
    np.maximum.at(largest, group, values)
    return largest


def _lines_between(cell: Array, ends: Array) -> Array:
    moved = np.sort(cell[ends], axis=1)
    return np.unique(moved[moved[:, 0] != moved[:, 1]], axis=0)
