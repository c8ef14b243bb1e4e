"""The numbers of a run as HTML."""

from __future__ import annotations

import html
import re
from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np

from ._places import Kind, number
from ._surface import Array

Cell = Union[str, int, float, bool, None]
Row = Tuple[str, Sequence[Cell]]
Measures = dict[str, Array]

DROPPED = {
    "nonfinite_vertices": "vertices that are not finite", "faces_with_nonfinite_vertices": "faces of such vertices",
    "short_faces": "faces of fewer than three corners", "degenerate_faces": "faces without area",
    "duplicate_faces": "repeated faces", "unreferenced_vertices": "vertices of no face",
    "nonmanifold_edges": "edges of three faces or more",
    "inconsistent_edges": "edges whose faces disagree about the outside",
    "other_primitives": "primitives that are no triangles", "posed_meshes": "poses of skins and morph targets",
    "long_rows": "rows with surplus values", "surplus_rows": "surplus rows", "surplus_bytes": "surplus bytes",
}
MENDED = {
    "joined_vertices": "vertices joined", "repeated_faces": "repeated faces removed",
    "fin_faces": "faces of fins removed", "island_faces": "faces of small islands removed",
    "turned_faces": "faces turned", "capped_loops": "holes capped",
    "tubes": "tubes between loops", "cap_faces": "faces of caps", "cap_area": "area of caps",
    "widest_cap": "width of the widest cap", "open_loops": "loops left open",
}
UNITED = {
    "turned_components": "parts turned inside out", "swallowed_components": "parts inside others swallowed",
    "inner_surfaces": "surfaces that bound hollows", "dropped_inner_components": "inner parts dropped",
    "cut_faces": "faces cut where parts meet", "internal_faces": "faces between parts left out",
    "separated_edges": "edges where surfaces touch, moved apart",
    "left_components": "parts left as they are",
}
BRIDGED = {"loops": "holes and gaps closed", "widest": "width of the widest",
           "area": "area without a surface of the input", "vertices": "vertices of the result there"}
TREATED = {"cut_handles": "handles cut", "failed_cells": "cells that failed", "inserted_seeds": "seeds inserted"}


MOST_REGIONS = 40  # of the table


def text(value: Cell) -> str:
    """As people read it; a dash for what is not known."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}".replace(",", "\u202f")
    return html.escape(number(value) if isinstance(value, float) else value)


def counted(count: int, what: str) -> str:
    return f"{text(count)} {what}{'' if count == 1 else 's'}"


def card(title: str, rows: Sequence[Row], columns: Sequence[str] = ()) -> str:
    """A table, unless it has no rows."""
    if not rows:
        return ""
    head = f"<tr><th></th>{''.join(f'<td>{html.escape(name)}</td>' for name in columns)}</tr>" if columns else ""
    body = "".join(f"<tr><th>{html.escape(name)}</th>{''.join(f'<td>{text(cell)}</td>' for cell in cells)}</tr>"
                   for name, cells in rows)
    return f'<div class="card"><h3>{html.escape(title)}</h3><table>{head}{body}</table></div>'


@dataclass
class Distances:
    """Between the result and a surface, both ways, each as (mean, rms, largest, mean and largest angle of normals).

    Distances are in world units, angles in degrees.
    """

    reference: str  # what the surface is, in words
    diagonal: float
    to_reference: Sequence[float]
    from_reference: Sequence[float]

    def ways(self) -> Tuple[Tuple[str, Sequence[float]], ...]:
        return ("result to input", self.to_reference), ("input to result", self.from_reference)

    def percent(self, distance: float) -> Optional[float]:
        """Of the diagonal."""
        return 100 * distance / self.diagonal if self.diagonal > 0 else None


def chips(report: dict[str, Any], missed: Sequence[str], distances: Optional[Distances]) -> str:
    """The verdict in a line."""
    topology, quality = report["topology"], report["quality"]
    borders = topology["boundary_loops"] or 0
    found: List[Tuple[bool, str]] = []
    if report["regions"]:
        found += _regions_found(report["regions"])
    elif topology["manifold"] is not None:
        kind = f"2-manifold with {counted(borders, 'border')}" if borders else "Closed 2-manifold"
        found.append((topology["manifold"], kind if topology["manifold"] else "Not a 2-manifold"))
    pairs = topology["self_intersections"]
    if pairs is not None:
        words = f"{counted(pairs, 'pair')} of triangles intersecting" if pairs else "No self-intersections"
        found.append((pairs == 0, words))
    if quality:
        found.append((quality["theta_min_deg"] >= 30, f"Smallest angle {quality['theta_min_deg']:.1f}°"))
    curves, lost = report["features"]["curves"], report["features"]["lost_curves"]
    if curves or lost:
        found.append((lost == 0, f"{counted(lost, 'curve')} lost" if lost else f"{counted(curves, 'curve')} kept"))
    if missed:
        found.append((False, f"{counted(len(missed), 'requirement')} missed"))
    made = "".join(f'<li class="{"met" if met else "missed"}">{html.escape(words)}</li>' for met, words in found)
    if distances and distances.diagonal > 0:
        largest = max(distances.to_reference[2], distances.from_reference[2])
        percent = number(100 * largest / distances.diagonal)
        made += f"<li>Within {percent} % of the diagonal of {distances.reference}</li>"
    return made


def _regions_found(regions: dict[str, Any]) -> List[Tuple[bool, str]]:
    """Whether each region is closed, and whether any or any wall was lost."""
    found = [(regions["every_region_closed"], f"{counted(len(regions['regions']), 'region')}, "
              + ("each is closed" if regions["every_region_closed"] else "not all closed"))]
    lost = len(regions.get("regions_lost", ())), len(regions.get("walls_lost", ()))
    if any(lost):
        found.append((False, f"{counted(lost[0], 'region')} and {counted(lost[1], 'wall')} lost"))
    return found


def regions(report: dict[str, Any]) -> str:
    """What each region measures, the largest first."""
    if not report["regions"]:
        return ""
    parts = sorted(report["regions"]["regions"], key=lambda region: -region["volume"])
    rows: List[Row] = [(f"{region['name']} ({region['label']})" if region["name"] else str(region["label"]),
                        [region["volume"], region["area"], region["triangles"]]) for region in parts[:MOST_REGIONS]]
    if len(parts) > MOST_REGIONS:
        rows.append((f"and {counted(len(parts) - MOST_REGIONS, 'smaller one')}", []))
    return card("Regions", rows, ("volume", "area", "triangles"))


def _named(words: str) -> str:
    """The words with names of options, and that of the requirement that they begin with, which no line may break."""
    return re.sub(r"--[a-z][a-z-]*|^[a-z]+(?:-[a-z]+)+", r'<span class="name">\g<0></span>', html.escape(words))


def gates(asked: Sequence[str], missed: Sequence[str]) -> str:
    """What was required, and whether it is so."""
    reasons = {words.split(":")[0].split("=")[0]: words for words in missed}
    rows = []
    for gate in asked:
        reason = reasons.pop(gate.split("=")[0], None)
        rows.append((reason is None, gate if reason is None else reason))
    rows += [(False, reason) for reason in reasons.values()]
    body = "".join(f'<tr><td class="mark {"met" if met else "missed"}"></td>'
                   f'<td class="text">{_named(words)}</td></tr>' for met, words in rows)
    return f'<div class="card"><h3>Requirements</h3><table>{body}</table></div>' if rows else ""


def certificate(report: dict[str, Any], before: Optional[Measures], after: Measures,
                distances: Optional[Distances]) -> str:
    """Topology, shape, distances, curves and borders."""
    source, topology, features = report["input"], report["topology"], report["features"]
    from_input = report["counts"]["sites"] is not None and source["vertices"] is not None
    given = {**source, **source["dropped"]}
    sides = ("input", "result")
    cards = card("Topology", [
        (name, (given.get(of_input) if from_input else None, topology[of_result])) for name, of_input, of_result in (
            ("closed", "closed", "closed"), ("components", "components", "components"), ("genus", "genus", "genus"),
            ("boundary loops", "boundary_loops", "boundary_loops"), ("2-manifold", None, "manifold"),
            ("edges of three faces or more", "nonmanifold_edges", "nonmanifold_edges"),
            ("vertices of several fans", None, "nonmanifold_vertices"),
            ("pairs of intersecting triangles", None, "self_intersections"))], sides)
    cards += card("Shape", [(name, (_of(before, measure), _of(after, measure))) for name, measure in MEASURES], sides)
    if distances:
        cards += card(f"Distance between the result and {distances.reference}", [
            (f"{name}, {way}", (side[i], distances.percent(side[i])))
            for way, side in distances.ways() for i, name in enumerate(("mean", "rms", "max"))],
            ("world units", "% of diagonal"))
        cards += card(f"Angle between normals of the result and {distances.reference}, degrees",
                      [(way, tuple(side[3:])) for way, side in distances.ways()], ("mean", "largest"))
    if features["curves"] or features["lost_curves"]:
        cards += card("Curves", [
            ("curves of the input", (features["curves"],)), ("of them seams", (features["seams"],)),
            ("of them lines", (features["lines"],)), ("corners", (features["corners"],)),
            ("patches", (features["patches"],)), ("length", (features["length"],)),
            ("lost", (features["lost_curves"],)), ("length of those", (features["lost_length"],))])
    if report["borders"]:
        borders = report["borders"]
        cards += card("Borders, those of the input once it is repaired", [
            ("loops", (borders["input_loops"], borders["loops"])),
            ("length", (borders["input_length"], borders["length"])),
            ("farthest from the other's", (borders["from_input_max"], borders["to_input_max"]))], sides)
    return cards + _run(report)


def _run(report: dict[str, Any]) -> str:
    grid, memory = report["grid"], report["memory_bytes"]
    rows: List[Row] = [("voxels along the longest side", (grid["resolution"],)), ("voxel size", (grid["voxel_size"],)),
                       ("device", (report["device"],)), ("seconds", (report["timings_ms"]["total"] / 1000,)),
                       ("memory of the process, MB", (memory["host_peak"] / 1e6,))]
    rows += [(f"digest of {name}", (value,)) for name, value in report["digests"].items() if name == "mesh"]
    return card("Run", rows)


def changes(report: dict[str, Any]) -> str:
    """What was repaired, bridged, dropped and merged, as counts."""
    source = report["input"]
    parts = [("Found in the input and dropped or treated", DROPPED, source["dropped"]),
             ("Mended", MENDED, source["mended"]), ("United", UNITED, source["united"]),
             ("Bridged", BRIDGED, report["gaps"]),
             ("Treated on the way", TREATED, report["topology"])]
    cards = "".join(card(title, [(words, (values[key],)) for key, words in names.items() if values[key]])
                    for title, names, values in parts)
    cards += card("Attributes", [(name, ("kept",)) for name in report["attributes"]["kept"]]
                  + [(lost["name"], (f"dropped: {lost['reason']}",)) for lost in report["attributes"]["dropped"]])
    return f'<section><h2>What was changed</h2><div class="tables">{cards}</div></section>' if cards else ""


def warnings(report: dict[str, Any]) -> str:
    items = "".join(f"<li>{_named(warning)}</li>" for warning in report["warnings"])
    return f'<section><h2>Warnings</h2><ul class="warnings">{items}</ul></section>' if items else ""


def places(kinds: Sequence[Kind]) -> str:
    """A button for each place; its number is that in the page's data."""
    cards, at = "", 0
    for kind in kinds:
        buttons = ""
        for place in kind.places:
            buttons += f'<li><button type="button" data-place="{at}">{html.escape(place.text)}</button></li>'
            at += 1
        rest = kind.count - len(kind.places)
        more = f"<p>and {text(rest)} more</p>" if rest > 0 else ""
        cards += (f'<div class="kind {kind.tone}"><h3>{html.escape(kind.title)} <small>{text(kind.count)}</small></h3>'
                  f"<ol>{buttons}</ol>{more}</div>")
    return f'<section><h2>Places to look at</h2><div class="places">{cards}</div></section>' if cards else ""


def measured(angles: Array, quality: Array, lengths: Array, valence: Array) -> Measures:
    return {"angles": angles, "quality": quality, "lengths": lengths, "valence": valence[valence > 0]}


def _of(values: Optional[Measures], measure: Any) -> Cell:
    return None if values is None or not len(values["angles"]) else measure(values)


MEASURES = (
    ("triangles", lambda v: len(v["quality"])),
    ("smallest angle", lambda v: f"{v['angles'].min():.2f}°"),
    ("mean of the triangles' smallest angles", lambda v: f"{v['angles'].reshape(-1, 3).min(axis=1).mean():.2f}°"),
    ("largest angle", lambda v: f"{v['angles'].max():.2f}°"),
    ("triangles with an angle below 30°", lambda v: int((v["angles"].reshape(-1, 3).min(axis=1) < 30).sum())),
    ("smallest quality", lambda v: float(v["quality"].min())),
    ("mean quality", lambda v: float(v["quality"].mean())),
    ("vertices without six neighbours", lambda v: f"{100 * np.mean(v['valence'] != 6):.1f} %"),
    ("mean edge length", lambda v: float(v["lengths"].mean())),
    ("variation of edge lengths", lambda v: f"{100 * v['lengths'].std() / v['lengths'].mean():.1f} %"),
)
