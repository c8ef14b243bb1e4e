"""From where a place can be seen."""

from __future__ import annotations

import itertools
from typing import Dict, Tuple

import numpy as np

from ._surface import Array, Surface

FAR_ENOUGH = 2.4  # times what should be seen
AROUND = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
AROUND /= np.linalg.norm(AROUND, axis=1)[:, None]


def clear_sight(at: Array, size: float, shown: Dict[str, Surface]) -> Tuple[Array, float]:
    """Direction, of length 1, and distance of an eye that sees as much around the place.

    It is above the surface, or as near to that as nothing is between; nearer where everything is shut in.
    """
    distance = FAR_ENOUGH * size
    normal = _normal_around(shown["after"], at, size / 2)
    others = AROUND[np.argsort(-(AROUND @ normal), kind="stable")]
    best, farthest = normal, 0.0
    for direction in [normal, *others[others @ normal > 0.2]]:
        free = min(_first_hit(surface, at, direction, 0.1 * size, distance) for surface in shown.values())
        if free > farthest:
            best, farthest = direction, free
        if farthest >= distance:
            break
    return best, farthest if farthest >= distance else 0.8 * farthest


def _normal_around(surface: Surface, at: Array, radius: float) -> Array:
    """The mean of the surface's normals in a ball; of the nearest face where none is inside."""
    corners = surface.vertices[surface.faces]
    away = np.linalg.norm(corners.mean(axis=1) - at, axis=1)
    near = corners[away <= max(radius, float(away.min()))]
    normal = np.cross(near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]).sum(axis=0)
    length = float(np.linalg.norm(normal))
    return np.asarray(normal / length) if length > 0 else np.array([0.0, 0.0, 1.0])


def _first_hit(surface: Surface, at: Array, direction: Array, nearest: float, farthest: float) -> float:
    """How far along a ray a face is, beyond `nearest`; `farthest` where there is none before."""
    a, b, c = (surface.vertices[surface.faces[:, i]] for i in range(3))
    one, two, start = b - a, c - a, at - a
    across = np.cross(direction, two)
    scale = np.einsum("ij,ij->i", one, across)
    turned = np.cross(start, one)
    with np.errstate(divide="ignore", invalid="ignore"):  # of faces along the ray; they are not hit
        u = np.einsum("ij,ij->i", start, across) / scale
        v = turned @ direction / scale
        t = np.einsum("ij,ij->i", two, turned) / scale
        hits = t[(u >= 0) & (v >= 0) & (u + v <= 1) & (t > nearest) & (t < farthest)]
    return float(hits.min()) if len(hits) else farthest
