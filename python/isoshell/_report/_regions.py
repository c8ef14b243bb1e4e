"""The regions of a result as the page shows them: each by itself, in a colour of its own."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from typing import Dict, List, Optional

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
    away: Array  # how far it is moved where regions are pulled apart, world units


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
    ways = _ways_apart(surfaces, after, len(labels))
    return [Region(_words(result, int(label)), _color(i), ways[i]) for i, label in enumerate(labels)]


def _ways_apart(surfaces: List[Surface], after: Surface, count: int) -> Array:
    """Of each region: from the middle of all to its own, and out of the regions that it is shut in, along x."""
    centres = [_centres(surfaces, number) for number in range(1, count + 1)]
    middle = _middle(after.vertices[after.faces].mean(axis=1))
    ways = np.array([_middle(points) - middle for points in centres]).reshape(-1, 3)
    around = _shut_in(np.concatenate([_pairs(surface) for surface in surfaces]), count)
    for number in range(1, count + 1):
        outer = around[number]
        while outer > 0:
            ways[number - 1, 0] += float(np.ptp(centres[outer - 1][:, 0]))
            outer = around[outer]
    return ways


def _shut_in(pairs: Array, count: int) -> List[int]:
    """Of 0 and each region the region that every way to it from 0 leads through, 0 for none: its immediate dominator
    in the graph of regions that share walls (Cooper, Harvey, Kennedy, 2001)."""
    beside: List[List[int]] = [[] for _ in range(count + 1)]
    for one, other in np.unique(np.sort(pairs, axis=1), axis=0).tolist():
        beside[one].append(other)
        beside[other].append(one)
    order, rank = [0], {0: 0}  # breadth first
    for region in order:
        for other in beside[region]:
            if other not in rank:
                rank[other] = len(order)
                order.append(other)
    around = {0: 0}
    changed = True
    while changed:
        changed = False
        for region in order[1:]:
            known = [other for other in beside[region] if other in around and other != region]
            common = known[0]
            for other in known[1:]:
                common = _common(common, other, around, rank)
            changed |= around.get(region) != common
            around[region] = common
    return [around.get(region, 0) for region in range(count + 1)]


def _common(one: int, other: int, around: Dict[int, int], rank: Dict[int, int]) -> int:
    """The innermost region around both, each of which is around itself."""
    while one != other:
        if rank[one] < rank[other]:
            one, other = other, one
        one = around[one]
    return one


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
