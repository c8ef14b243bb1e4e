"""The regions of a result as the page shows them: each by itself, in a colour of its own."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from typing import List, Optional

import numpy as np

from .._result import Result
from ._surface import Array, Surface

GOLDEN_PART = 0.6180339887498949  # of the circle of hues: no two of few regions are near
SHADES = ((0.62, 0.58), (0.45, 0.72), (0.74, 0.5))  # lightness and saturation, in turn
MOST = 2**16 - 1  # that numbers of two bytes tell apart; a result of more is shown without


@dataclass
class Region:
    words: str
    color: str  # as CSS has it
    away: Array  # from the middle of all to its own, world units


def numbered(result: Result, after: Surface, before: Optional[Surface]) -> List[Region]:
    """The regions of a result and its input, ascending by label; faces get their numbers, from 1, for labels.

    0 is what is no region. None where the result has none, or too many.
    """
    surfaces = [surface for surface in (after, before) if surface is not None and surface.regions is not None]
    background = result.regions["background"]
    labels = np.unique(np.concatenate([_pairs(surface).ravel() for surface in surfaces])) if surfaces else np.empty(0, int)
    labels = labels[labels != background]
    if after.regions is None or len(labels) > MOST:
        for surface in surfaces:
            surface.regions = None
        return []
    for surface in surfaces:
        pairs = _pairs(surface)
        surface.regions = np.where(pairs == background, 0, np.searchsorted(labels, pairs) + 1)
    middle = _middle(after.vertices[after.faces].mean(axis=1))
    return [Region(_words(result, int(label)), _color(i), _middle(_centres(surfaces, i + 1)) - middle)
            for i, label in enumerate(labels)]


def _pairs(surface: Surface) -> Array:
    assert surface.regions is not None
    return surface.regions


def _centres(surfaces: List[Surface], number: int) -> Array:
    """Of the faces of a region, in the first of the surfaces that has any."""
    for surface in surfaces:
        faces = surface.faces[(_pairs(surface) == number).any(axis=1)]
        if len(faces):
            break
    centres: Array = surface.vertices[faces].mean(axis=1)
    return centres


def _words(result: Result, label: int) -> str:
    name = result.region_names.get(label)
    return f"{name} ({label})" if name else str(label)


def _middle(points: Array) -> Array:
    middle: Array = (points.min(axis=0) + points.max(axis=0)) / 2
    return middle


def _color(number: int) -> str:
    lightness, saturation = SHADES[number % len(SHADES)]
    parts = colorsys.hls_to_rgb((0.58 + number * GOLDEN_PART) % 1, lightness, saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in parts)
