"""What a person should look at, and where it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Iterable, List, Optional

import numpy as np

from ._surface import Array, Edges, Surface, groups

MOST = 12  # of one kind


@dataclass
class Place:
    """One of a kind, with what is said of it; `size` is how much around it should be seen, world units."""

    text: str
    at: Array  # (3,)
    size: float


@dataclass
class Kind:
    """Places of one kind, the worst first; there may be more than are listed."""

    title: str
    places: List[Place]
    count: int
    tone: str = "note"  # or "poor": something that a person may want to mend


def number(value: float) -> str:
    """Four digits, as people write them."""
    return f"{value:.4g}"


def kinds_of(report: dict[str, Any], before: Optional[Surface], after: Surface, edge: float) -> List[Kind]:
    """Everything of a run that has a place; `edge` is the mean length of the result's edges."""
    found = [*_of_statistics(report, edge), *_of_result(after, edge)]
    if before is not None:
        found += _of_input(before, after, edge)
    return [kind for kind in found if kind.count]


def _of_statistics(report: dict[str, Any], edge: float) -> Iterable[Kind]:
    topology, quality = report["topology"], report["quality"] or {}
    at = topology["intersection_at"]
    yield _kind("Self-intersections of the result",
                [Place(f"the first of {topology['self_intersections']} pairs", np.array(at), 6 * edge)] if at else [],
                count=int(topology["self_intersections"]) if at else 0, tone="poor")
    features = report["features"]
    yield _kind("Curves that were lost", [
        Place(f"{curve['kind']}, {number(curve['length'])} long: {curve['reason']}", np.array(curve["at"]),
              max(6 * edge, float(curve["length"]))) for curve in features["lost"] if curve["at"]],
                count=int(features["lost_curves"]), tone="poor")
    poor = sorted(quality.get("poor_angles", []), key=lambda angle: float(angle["degrees"]))
    yield _kind("Poor angles", [Place(f"{angle['degrees']:.1f}°", np.array(angle["at"]), 6 * edge) for angle in poor],
                count=max(len(poor), int(quality.get("below_30_deg", 0)) if poor else 0), tone="poor")
    united = report["input"]["united"]
    if united["not_joined_at"]:
        yield _kind("Parts that were not united",
                    [Place(str(united["not_joined"]), np.array(united["not_joined_at"]), 10 * edge)], tone="poor")


def _of_result(after: Surface, edge: float) -> Iterable[Kind]:
    """Where the result has a surface and the input has none; each with a vertex in its middle."""
    gap = after.of_vertices.get("gap")
    if gap is None:
        return
    edges = after.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ends = edges[gap[edges].astype(bool).all(axis=1)]
    inside = np.flatnonzero(gap)
    patches = _patches(after.vertices, inside, groups(len(after.vertices), ends)[inside])
    yield _kind("Gaps bridged", [Place(f"{len(patch)} vertices of the result", _middle(after.vertices[patch]),
                                       _extent(after.vertices[patch], edge)) for patch in patches])


def _of_input(before: Surface, after: Surface, edge: float) -> Iterable[Kind]:
    edges = Edges.of(before)
    kept = after.vertices[np.unique(after.lines["border"])] if len(after.lines.get("border", [])) else None
    closed: List[Place] = []
    borders: List[Place] = []
    open_ends = edges.ends[edges.faces == 1]
    for loop, length in _chains(before, open_ends):
        around = before.vertices[loop]
        place = Place(f"{number(length)} long, {len(loop)} vertices", _nearest(after.vertices, around.mean(axis=0)),
                      _extent(around, edge))
        is_kept = kept is not None and np.linalg.norm(kept - before.vertices[loop[0]], axis=1).min() < 2 * edge
        (borders if is_kept else closed).append(place)
    yield _kind("Open borders of the input that were closed", closed)
    yield _kind("Borders that were kept", borders)
    if before.regions is None:  # else walls meet there
        yield _kind("Edges of three faces or more in the input", [
            Place(f"{number(length)} long", _middle(before.vertices[line]), _extent(before.vertices[line], edge))
            for line, length in _chains(before, edges.ends[edges.faces > 2])])
    yield _kind("Pieces of the input that are not in the result", list(_left_out(before, edges, edge)))
    yield _kind("Farthest from the result", list(_farthest(before, edge)))
    yield _kind("Farthest from the input as it was read", list(_farthest(after, edge)))


def _chains(surface: Surface, ends: Array) -> Iterable[tuple[Array, float]]:
    """Vertices that these edges connect, with the edges' length; the longest first."""
    used, local = np.unique(ends, return_inverse=True)
    local = local.reshape(-1, 2)
    group = groups(len(used), local)
    length = np.linalg.norm(surface.vertices[ends[:, 0]] - surface.vertices[ends[:, 1]], axis=1)
    total = np.bincount(group[local[:, 0]], length, minlength=len(used))
    order = np.argsort(group, kind="stable")
    heads, first = np.unique(group[order], return_index=True)
    chains = [(head, chain) for head, chain in zip(heads, np.split(order, first[1:]))] if len(used) else []
    for head, chain in sorted(chains, key=lambda item: -float(total[item[0]])):
        yield used[chain], float(total[head])


def _patches(vertices: Array, inside: Array, group: Array) -> List[Array]:
    """The vertices of each group, those of the most first."""
    order = np.argsort(group, kind="stable")
    _, first = np.unique(group[order], return_index=True)
    parts = np.split(inside[order], first[1:]) if len(inside) else []
    return sorted(parts, key=len, reverse=True)


def _left_out(before: Surface, edges: Edges, edge: float) -> Iterable[Place]:
    """Pieces of which even the nearest vertex is farther from the result than one of its edges is long."""
    away = before.of_vertices.get("deviation")
    if away is None:
        return
    group = groups(len(before.vertices), edges.ends)
    used = np.unique(before.faces)
    nearest = np.full(len(before.vertices), np.inf)
    np.minimum.at(nearest, group[used], away[used])
    faces = np.bincount(group[before.faces[:, 0]], minlength=len(group))
    pieces = np.flatnonzero((nearest > edge) & np.isfinite(nearest))
    for piece in pieces[np.argsort(-faces[pieces], kind="stable")]:
        at = before.vertices[group == piece] if len(pieces) <= 2 * MOST else before.vertices[[piece]]
        yield Place(f"{faces[piece]} faces, {number(nearest[piece])} away", _middle(at), _extent(at, edge))


def _farthest(surface: Surface, edge: float, count: int = 3) -> Iterable[Place]:
    """The vertices that are farthest from the other mesh, none beside another."""
    away = surface.of_vertices.get("deviation")
    if away is None or not len(away):
        return
    taken: List[Array] = []
    for vertex in np.argsort(-away, kind="stable")[:2000]:
        at = surface.vertices[vertex]
        if away[vertex] > 0 and all(np.linalg.norm(at - other) > 8 * edge for other in taken):
            taken.append(at)
            yield Place(f"{number(away[vertex])} away", at, 8 * edge)
        if len(taken) == count:
            return


def _kind(title: str, places: List[Place], *, count: Optional[int] = None, tone: str = "note") -> Kind:
    return Kind(title, places[:MOST], len(places) if count is None else count, tone)


def _middle(points: Array) -> Array:
    """The point that is nearest to the middle of all."""
    return _nearest(points, points.mean(axis=0))


def _nearest(points: Array, at: Array) -> Array:
    nearest: Array = points[np.linalg.norm(points - at, axis=1).argmin()]
    return nearest


def _extent(points: Array, edge: float) -> float:
    return max(float((points.max(axis=0) - points.min(axis=0)).max()), 6 * edge)
