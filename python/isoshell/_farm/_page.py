"""isoshell farm report: a page of all assets, one file that needs no network."""

from __future__ import annotations

import html
import math
import os
import time
import urllib.parse
from typing import List, Optional

import numpy as np

import isoshell

from .. import _isoshell, _report
from .._errors import Error
from .._report import _template
from .._report._charts import histogram
from . import _manifest as manifest
from . import _places as places
from ._admission import text_of
from ._progress import tell
from ._status import counts_of, read_farm, reasons_of

MOST_FAILED = 1000  # of a reason
MOST_DONE = 5000
FEW = 25
CHARTS = (("seconds", "Seconds", 1.0), ("peak_memory", "Peak memory, MB", float(1 << 20)),
          ("min_angle", "Smallest angle, degrees", 1.0), ("quality", "Mean quality of triangles", 1.0),
          ("deviation_pct", "Largest deviation, % of the diagonal", 1.0), ("input_size", "Size of the input, MB", 1e6))
PARTS = 4  # of an axis
STEPS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)  # and these times powers of ten
FIXED = {"min_angle": (0.0, 60.0), "quality": (0.0, 1.0)}


def report(out: str, output: Optional[str], parquet: Optional[str]) -> int:
    """Writes it, and the table. What is amiss with their places is told before the manifest is read. Returns the exit
    status."""
    if output is None and places.is_remote(out):
        raise Error(f"{out} is not on this machine; say with --output where the page goes", stage="report")
    target = output or os.path.join(out, "report.html")
    page_there = [("--output", target)] if output or os.path.isdir(out) else []
    _isoshell.check_output_files([*page_there, ("--parquet", parquet or "")], [], True)
    if parquet:
        manifest.parquet_library()
    found = read_farm(out)
    text = page(found, out, os.path.dirname(os.path.abspath(target)))
    _isoshell.write_text(target, text.encode("utf-8", "backslashreplace").decode(), True)
    if parquet:
        manifest.compact(found, parquet)
    tell(target)
    return 0


def page(found: manifest.Manifest, out: str, folder: str) -> str:
    """The whole file; links are relative to the folder that it is in."""
    counts, reasons = counts_of(found), reasons_of(found.rows)
    done = [row for row in found.rows.values() if row["state"] == "done"]
    done.sort(key=lambda row: -float(row["seconds"]))
    base = out if places.is_remote(out) else os.path.relpath(places.local(out), folder)
    chips = [f"{counts.done} done", f"{counts.failed} failed", f"{counts.remaining} remaining"]
    if counts.a_second:
        chips.append(f"{counts.a_second:.2g} assets a second")
    marks = ("met", "missed" if counts.failed else "met", "", "")
    blanks = {
        "title": f"{html.escape(os.path.basename(out.rstrip('/')) or out)} – isoshell farm",
        "heading": html.escape(out),
        "subtitle": f"{counts.assets} assets, "
                    + time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(float(found.runs[-1]["time"]))),
        "chips": "".join(f'<li class="{mark}">{text}</li>' for text, mark in zip(chips, marks)),
        "failed": "".join(_reason(code, rows, base) for code, rows in reasons.items()),
        "charts": "".join(_chart(done, *chart) for chart in CHARTS),
        "slowest": _table(done[:FEW], base),
        "done": _all_done(done, base),
        "command": html.escape(str(found.runs[-1]["command"])),
        "version": html.escape(isoshell.__version__),
        "css": _template.text_of(_report.__name__, "page.css"),
    }
    return _template.filled(str(__package__), blanks)


def _reason(code: str, rows: List[manifest.Row], base: str) -> str:
    lines = "".join(f'<tr><td class="text">{_name(row, base)}</td><td class="text">{html.escape(str(row["message"]))}'
                    f'</td><td>{row["seconds"]:.1f} s</td><td>{row["attempts"]}</td></tr>'
                    for row in rows[:MOST_FAILED])
    more = f"<p>and {len(rows) - MOST_FAILED} more, in the manifest</p>" if len(rows) > MOST_FAILED else ""
    opened = " open" if len(rows) <= FEW else ""
    return (f'<details{opened}><summary class="missed">{html.escape(code)}: {len(rows)}</summary>'
            f'<div class="card"><table><tr><th>asset</th><th>reason</th><th>time</th><th>attempts</th>'
            f"</tr>{lines}</table>{more}</div></details>")


def _all_done(rows: List[manifest.Row], base: str) -> str:
    more = f", of which the {MOST_DONE} slowest are here and all in the manifest" if len(rows) > MOST_DONE else ""
    return f"<details><summary>All that are done: {len(rows)}{more}</summary>{_table(rows[:MOST_DONE], base)}</details>"


def _table(rows: List[manifest.Row], base: str) -> str:
    names = ("asset", "time", "memory", "vertices", "smallest angle", "quality", "deviation")
    head = "".join(f"<th>{name}</th>" for name in names)
    lines = "".join(
        f"<tr><td class=\"text\">{_name(row, base)}</td><td>{row['seconds']:.1f} s</td>"
        f"<td>{text_of(row.get('peak_memory'))}</td><td>{_number(row, 'vertices', 'd')}</td>"
        f"<td>{_number(row, 'min_angle', '.1f')}°</td><td>{_number(row, 'quality', '.3f')}</td>"
        f"<td>{_number(row, 'deviation_pct', '.2f')} %</td></tr>" for row in rows)
    return f'<div class="card"><table><tr>{head}</tr>{lines}</table></div>'


def _number(row: manifest.Row, name: str, form: str) -> str:
    return "–" if row.get(name) is None else format(row[name], form)


def _name(row: manifest.Row, base: str) -> str:
    """The asset, with a link to its mesh where there is one of one file."""
    made = row["output"] if row["state"] == "done" else row.get("rejected")
    name = html.escape(str(row["asset"]))
    if not made or row["options"].get("frames"):
        return name
    return f'<a href="{html.escape(_link(base, str(made)))}">{name}</a>'


def _link(base: str, made: str) -> str:
    if places.is_remote(base):
        return f"{base.rstrip('/')}/{_quoted(made)}"
    return _quoted(f"{base}/{made}")


def _quoted(path: str) -> str:
    return urllib.parse.quote(path, errors="surrogateescape")


def _chart(rows: List[manifest.Row], key: str, title: str, scale: float) -> str:
    values = np.array([float(row[key]) / scale for row in rows if row.get(key) is not None])
    if not len(values):
        return ""
    span = FIXED.get(key) or (0.0, PARTS * _step(max(float(np.percentile(values, 99)), 1e-9) / PARTS))
    return histogram(title, "", None, values, span, PARTS)


def _step(least: float) -> float:
    """A number of few digits, so that what is written at an axis has room."""
    power = 10.0 ** math.floor(math.log10(least))
    return next(step for step in STEPS if step * power >= least * (1 - 1e-9)) * power
