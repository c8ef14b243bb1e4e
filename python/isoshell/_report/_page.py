"""The page: one file that needs no network."""

from __future__ import annotations

import base64
import html
import json
import re
import zlib
from importlib.metadata import version
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np

from .. import _isoshell
from .._result import Result
from . import _charts as charts
from . import _tables as tables
from . import _regions as regions
from ._places import Kind, Place, kinds_of, number
from ._sight import clear_sight
from ._surface import Array, Edges, Surface, angles_deg, edge_lengths, face_quality, joined, thinned
from ._template import filled, text_of

MOST_FACES = 120_000  # of a mesh that is drawn: the page stays below 8 MB
PATCH_COLORS = 8  # of page.js
MODES = (("shape", "Shape"), ("deviation", "Deviation"), ("quality", "Quality"), ("valence", "Valence"),
         ("gaps", "Gaps and borders"), ("creases", "Creases"))
Y_IS_UP = (".glb", ".gltf", ".obj", ".vdb", ".nvdb")  # by specification or habit; parts, scans and surveys have z up


def page(result: Result, source: Optional[tuple[Array, Array, Array]], k3d: Path) -> str:
    """The whole file; `k3d` is the folder of the library's scripts."""
    report = result.report
    after, of_after = _after(result)
    before, of_before = _before(source)
    if before is not None:
        _measure_distances(before, after)
    distances = _distances(report, before, after)
    edge = float(of_after["lengths"].mean()) if len(of_after["lengths"]) else 1.0
    kinds = kinds_of(report, before, after, edge)
    name = Path(report["input"]["path"]).name or "surface"
    drawn = [(side, surface) for side, surface in (("before", before), ("after", after)) if surface is not None]
    shown = {side: thinned(surface, MOST_FACES) for side, surface in drawn}
    parts = regions.numbered(result, after, before)
    counts = report["counts"]
    modes, first = ((("regions", "Regions"), *MODES), "regions") if parts else (MODES, "shape")
    blanks = {
        "title": html.escape(f"{name} – isoshell report"),
        "heading": html.escape(name),
        "subtitle": f"Remeshed to {tables.text(counts['vertices'])} vertices and "
                    f"{tables.text(counts['triangles'])} triangles",
        "chips": tables.chips(report, result._made.missed_gates, distances),
        "modes": "".join(_radio("mode", key, words, key == first) for key, words in modes),
        "ups": "".join(_radio("up", axis, axis.upper(), axis == _up_axis(result)) for axis in "xyz"),
        "panes": "".join(_pane(side, name, surface, report) for side, surface in drawn),
        "thinned": " ".join(_how_many(side, surface, shown[side]) for side, surface in drawn).strip(),
        "places": tables.places(kinds),
        "key": _key(before is not None),
        "charts": _charts(report, of_before, of_after),
        "certificate": tables.gates(result._made.gates, result._made.missed_gates)
                       + tables.regions(report) + tables.certificate(report, of_before, of_after, distances),
        "changes": tables.changes(report),
        "warnings": tables.warnings(report),
        "json": html.escape(json.dumps(report, indent=1, ensure_ascii=False)),
        "version": html.escape(str(report["version"])),
        "k3d": html.escape(version("k3d")),
        "data": _data(shown, kinds, drawn, parts) + _script("k3d", _packed(_without_fonts_of_files(k3d / "standalone.js"))),
        "fflate": (k3d / "fflate.js").read_text(),
        "css": text_of(str(__package__), "page.css"),
        "js": text_of(str(__package__), "page.js"),
    }
    return filled(str(__package__), blanks)


def _without_fonts_of_files(script: Path) -> bytes:
    """The library, which also names files of its fonts beside those that it holds: a browser would look for them."""
    return re.sub(r',url\(fonts/[^)]*\) format\("(?:woff|truetype)"\)', "", script.read_text("utf-8")).encode()


def _after(result: Result) -> tuple[Surface, tables.Measures]:
    surface = Surface(result.vertices, result.faces.astype(np.int64))
    edges, measures = _measure(surface)
    gap = result.attributes.get("gap")
    if gap is not None:
        surface.of_vertices["gap"] = (gap != 0).astype(np.uint8)
    if len(result.regions["labels"]):
        surface.regions = result.regions["labels"]
    features = result.features
    surface.lines["border"] = edges.ends[edges.faces == 1]
    surface.lines["curve"] = features["curve_edges"].astype(np.int64)
    if len(np.unique(features["patch"])) > 1:
        surface.color = _colors_of(features["patch"], surface, edges)
    return surface, measures


def _colors_of(patch: Array, surface: Surface, edges: Edges) -> Array:
    """A colour for each face, by its patch: other ones beside it, as far as there are colours."""
    neighbours: dict[int, set[int]] = {}
    for one, other in np.unique(edges.sides(patch, len(surface.vertices), surface.faces), axis=0).tolist():
        neighbours.setdefault(one, set()).add(other)
        neighbours.setdefault(other, set()).add(one)
    color: dict[int, int] = {}
    for name in np.unique(patch).tolist():
        taken = [color[other] for other in neighbours.get(name, ()) if other in color]
        color[name] = min(range(PATCH_COLORS), key=lambda number: (taken.count(number), number))
    return np.array([color[name] for name in patch.tolist()], np.uint8)


def _before(source: Optional[tuple[Array, Array, Array]]) -> tuple[Optional[Surface], Optional[tables.Measures]]:
    surface = joined(*source) if source is not None else None
    if surface is None or not len(surface.faces):
        return None, None
    edges, measures = _measure(surface)
    surface.lines["border"] = edges.ends[edges.faces == 1]
    if surface.regions is None:  # else walls meet there, and that is no flaw
        surface.lines["nonmanifold"] = edges.ends[edges.faces > 2]
    return surface, measures


def _measure(surface: Surface) -> tuple[Edges, tables.Measures]:
    """Measures, which the surface keeps as values to be drawn; thinning takes the largest, so poor is large."""
    edges = Edges.of(surface)
    quality, valence = face_quality(surface), edges.valence(len(surface.vertices))
    surface.of_faces["poorness"] = (255 * (1 - np.clip(quality, 0, 1))).round().astype(np.uint8)
    used = valence > 0
    surface.of_vertices["fewer"] = np.where(used, np.clip(6 - valence, 0, 3), 0).astype(np.uint8)
    surface.of_vertices["more"] = np.where(used, np.clip(valence - 6, 0, 3), 0).astype(np.uint8)
    return edges, tables.measured(angles_deg(surface), quality, edge_lengths(surface, edges), valence)


def _measure_distances(before: Surface, after: Surface) -> None:
    for one, other in ((before, after), (after, before)):
        one.of_vertices["deviation"] = _isoshell.distances(one.vertices, other.vertices, other.faces)


def _distances(report: dict[str, Any], before: Optional[Surface], after: Surface) -> Optional[tables.Distances]:
    """A run measures to the repaired input; the page draws and lists the input as it was read, so that it is here."""
    if not report["distance"]:
        return None
    if before is not None:
        measures = _isoshell.surface_distance(after.vertices, after.faces, before.vertices, before.faces)
        return tables.Distances("the input as it was read", *measures)
    distance, normals = report["distance"], report["normals"]
    to, back = ([*(distance[f"{side}_{name}"] for name in ("mean", "rms", "max")),
                 *(normals[f"{side}_{name}_deg"] for name in ("mean", "max"))] for side in ("to_input", "from_input"))
    return tables.Distances("the repaired input", distance["diagonal"], to, back)


def _data(shown: Dict[str, Surface], kinds: List[Kind], drawn: list[tuple[str, Surface]],
          parts: List[regions.Region]) -> str:
    """Positions are counted in 65535ths of the box around everything that is drawn."""
    all_points = np.concatenate([surface.vertices[np.unique(surface.faces)] for surface in shown.values()])
    low, high = all_points.min(axis=0), all_points.max(axis=0)
    size = max(float((high - low).max()), 1e-300)
    away = [surface.of_vertices["deviation"] for _, surface in drawn if "deviation" in surface.of_vertices]
    top = max((float(np.percentile(values, 99)) for values in away), default=0.0)
    data: dict[str, Any] = {
        "box": ((high - low) / size).tolist(),
        "top": number(top),
        "largest": number(max((float(values.max()) for values in away), default=0.0)),
        "sides": {side: _encoded(surface, low, size, top) for side, surface in shown.items()},
        "regions": [{"words": region.words, "color": region.color, "away": (region.away / size).tolist()}
                    for region in parts],
        "places": [_view(place, shown, low, size) for kind in kinds for place in kind.places],
    }
    return _script("data", json.dumps(data), "application/json")


def _encoded(surface: Surface, low: Array, size: float, top: float) -> dict[str, str]:
    number_type = np.uint16 if len(surface.vertices) < 2**16 else np.uint32
    positions = np.clip((surface.vertices - low) / size, 0, 1)
    made = {"positions": _packed((positions * 65535).round().astype(np.uint16)),
            "faces": _packed(surface.faces.astype(np.uint32)),
            "poorness": _packed(surface.of_faces["poorness"])}
    for name in ("fewer", "more", "gap"):
        if name in surface.of_vertices:
            made[name] = _packed(surface.of_vertices[name].astype(np.uint8))
    if "deviation" in surface.of_vertices:
        part = np.clip(surface.of_vertices["deviation"] / max(top, 1e-300), 0, 1)
        made["deviation"] = _packed((255 * part).round().astype(np.uint8))
    if surface.color is not None:
        made["patch"] = _packed(surface.color)
    if surface.regions is not None:
        made["regions"] = _packed(surface.regions.astype(np.uint16))
    for name, ends in surface.lines.items():
        if len(ends):
            made[name] = _packed(ends.astype(np.uint32))
    return made


def _view(place: Place, shown: Dict[str, Surface], low: Array, size: float) -> dict[str, Any]:
    """Where a place is and where it is seen from, in the page's units."""
    direction, distance = clear_sight(place.at, place.size, shown)
    return {"at": ((place.at - low) / size).tolist(), "from": direction.tolist(), "distance": distance / size}


def _charts(report: dict[str, Any], before: Optional[tables.Measures], after: tables.Measures) -> str:
    def both(key: str) -> tuple[Optional[Array], Array]:
        return (before[key] if before else None), after[key]

    def relative(lengths: Optional[Array]) -> Optional[Array]:
        return None if lengths is None or not len(lengths) else lengths / max(float(lengths.mean()), 1e-300)

    lengths = relative(after["lengths"])
    assert lengths is not None
    made = charts.histogram("Angles", "°", *both("angles"), (0, 180), 6)
    made += charts.histogram("Quality of triangles", "", *both("quality"), (0, 1), 5)
    made += charts.histogram("Edge lengths, parts of the mean", "", relative(both("lengths")[0]), lengths, (0, 3), 6)
    energy = [100 * value / report["energy"][0] for value in report["energy"]] if report["energy"] else []
    return made + charts.curve("Energy by pass, % of the first", "", energy)


def _key(has_before: bool) -> str:
    return ('<i class="after"></i>result' + ('<i class="before"></i>input' if has_before else "")
            + ". Each mesh's bars add up to one.")


def _pane(side: str, name: str, surface: Surface, report: dict[str, Any]) -> str:
    made_of = {"points": ", the surface through its points", "volume": ", its surface",
               "stage": ", the surface it holds"}
    words = name + made_of.get(report["input"]["kind"], "") if side == "before" else "the result"
    count = f"{tables.text(len(surface.vertices))} vertices, {tables.text(len(surface.faces))} triangles"
    return (f'<figure class="pane"><figcaption><b>{side.capitalize()}</b>{html.escape(words)}: {count}</figcaption>'
            f'<div class="view" id="{side}"></div></figure>')


def _how_many(side: str, whole: Surface, shown: Surface) -> str:
    if shown is whole:
        return ""
    return (f"{side.capitalize()}: {tables.text(len(shown.faces))} triangles are drawn of "
            f"{tables.text(len(whole.faces))}, with the worst value of those that each stands for.")


def _radio(group: str, key: str, words: str, checked: bool) -> str:
    return (f'<label><input type="radio" name="{group}" value="{key}"{" checked" if checked else ""}>'
            f"<span>{words}</span></label>")


def _up_axis(result: Result) -> str:
    """What a scene says; else by the format, and that of arrays is z."""
    if result.origin is not None:
        return str(result.origin.up_axis).lower()
    file = str(result.report["input"]["path"]).lower()
    given = f".{result.report['options'].get('input_format') or ''}"
    is_y = given in Y_IS_UP or re.search("(%s)(:[^:/]*)?$" % "|".join(map(re.escape, Y_IS_UP)), file)
    return "y" if is_y else "z"


def _packed(values: Any) -> str:
    raw = values if isinstance(values, bytes) else np.ascontiguousarray(values).tobytes()
    return base64.b64encode(zlib.compress(raw, 9)).decode()


def _script(name: str, content: str, kind: str = "text/plain") -> str:
    """A browser ends, or goes on behind, a script by what begins with < in it: JSON may write that letter otherwise."""
    return f'<script type="{kind}" id="{name}">{content.replace("<", chr(92) + "u003c")}</script>\n'
