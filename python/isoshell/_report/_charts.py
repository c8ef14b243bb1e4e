"""Histograms and curves as SVG, in the colours of the page."""

from __future__ import annotations

import html
from typing import List, Optional, Sequence, Tuple

import numpy as np

from ._places import number
from ._surface import Array

WIDTH, HEIGHT = 300, 170
BINS = 48
LEFT, RIGHT, TOP, BOTTOM = 4, 296, 12, 142


def histogram(title: str, unit: str, before: Optional[Array], after: Array, span: Tuple[float, float],
              parts: int) -> str:
    """Shares of before (an outline) and after (bars); what lies beyond the span is in its last bars. The axis has so
    many parts."""
    shares = [np.histogram(np.clip(values, *span), BINS, span)[0] / max(len(values), 1)
              for values in (after, before) if values is not None]
    top = max(float(share.max()) for share in shares) or 1.0
    width = (RIGHT - LEFT) / BINS
    bars = "".join(f'<rect x="{LEFT + i * width + 0.5:.1f}" y="{_height(share, top):.1f}" width="{width - 1:.1f}" '
                   f'height="{BOTTOM - _height(share, top):.1f}"/>' for i, share in enumerate(shares[0]) if share > 0)
    drawn = f'<g class="after">{bars}</g>'
    if len(shares) > 1:
        steps = " ".join(f"H{LEFT + i * width:.1f}V{_height(share, top):.1f}" for i, share in enumerate(shares[1]))
        drawn += f'<path class="before" d="M{LEFT} {BOTTOM}{steps}H{RIGHT}V{BOTTOM}"/>'
    ticks = [(span[0] + (span[1] - span[0]) * i / parts, LEFT + (RIGHT - LEFT) * i / parts) for i in range(parts + 1)]
    return _chart(title, drawn + _axis(ticks, unit))


def curve(title: str, unit: str, values: Sequence[float]) -> str:
    """Values one after the other, on a logarithmic scale where they span more than a tenfold."""
    if len(values) < 2:
        return ""
    heights = np.array(values, float)
    if heights.min() > 0 and heights.max() > 10 * heights.min():
        heights = np.log10(heights)
    low, high = float(heights.min()), float(heights.max())
    x = np.linspace(LEFT, RIGHT, len(values))
    y = BOTTOM - (heights - low) / max(high - low, 1e-300) * (BOTTOM - TOP - 16)
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
    labels = (f'<text class="value" x="{LEFT + 6}" y="{max(y[0] - 6, TOP):.1f}">{number(values[0])}</text>'
              f'<text class="value" x="{RIGHT}" y="{min(y[-1] - 6, BOTTOM - 6):.1f}" text-anchor="end">'
              f"{number(values[-1])}</text>")
    ticks = [(float(i + 1), x[i]) for i in range(0, len(values), -(-(len(values) - 1) // 5))]
    return _chart(title, f'<polyline class="line" points="{points}"/>{labels}{_axis(ticks, unit)}')


def _height(share: float, top: float) -> float:
    return BOTTOM - share / top * (BOTTOM - TOP)


def _axis(ticks: List[Tuple[float, float]], unit: str) -> str:
    marks = "".join(f'<path class="axis" d="M{x:.1f} {BOTTOM}v4"/><text x="{x:.1f}" y="{BOTTOM + 17}" '
                    f'text-anchor="{_anchor(x)}">{number(value)}{html.escape(unit)}</text>' for value, x in ticks)
    return f'<path class="axis" d="M{LEFT} {BOTTOM}H{RIGHT}"/>{marks}'


def _anchor(x: float) -> str:
    return "start" if x <= LEFT else "end" if x >= RIGHT else "middle"


def _chart(title: str, drawn: str) -> str:
    name = html.escape(title)
    return (f'<figure><figcaption>{name}</figcaption><svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" '
            f'aria-label="{name}">{drawn}</svg></figure>')
