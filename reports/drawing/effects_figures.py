"""The pictures of an effects study as inline SVG: the rose of overturning amplitudes, and each condition's effect."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

import numpy as np
from markupsafe import Markup

from harness.records.effects3d import Band, Effect, EffectsRecord
from reports.charts.palette import HAIRLINE, INK, MUTED, look

SIZE: Final = 640.0
RADIUS: Final = 275.0
WIDE: Final = 940.0
ROW: Final = 30.0
LABELS: Final = 300.0
"""Width of the conditions' names."""
RIGHT: Final = 40.0
"""Room beside the last mark of the scale, for its label."""
BASELINE: Final = "shaken along one direction"
SIDES_COLOUR: Final = "#8a6d00"

Point = tuple[float, float | None]


@dataclass(frozen=True)
class Curve:
    """One closed curve of a rose: (azimuth in degrees, peak in g; None where the statue stands up to the most tried)."""

    name: str
    points: Sequence[Point]
    colour: str
    dash: str
    width: float


def curves(record: EffectsRecord) -> list[Curve]:
    """The curves of a record: every engine's, and the planar model asked at the base's sides."""
    engines = record.engines
    found = []
    for name in engines[::-1]:
        points = [(row.azimuth_deg, row.peak_g) for row in record.amplitudes(name, BASELINE)]
        style = look(name, engines)
        found.append(Curve(name, points, style.colour, style.dash.replace("px", ""), style.width + 0.4))
    sides = [(row.azimuth_deg, row.projected_g) for row in record.static]
    return [*found, Curve("analytic, at the base's sides", sides, SIDES_COLOUR, "1.5,4", 2.6)]


def rose(record: EffectsRecord) -> Markup:
    """The least peak that overturns by direction; curves end on the rim where the statue stands up to the most tried."""
    most = record.study.search.most_g
    parts = [*_rings(most), _base(record), *_band(record.bands, most)]
    lifts = [_place(row.azimuth_deg, row.lifts_g, most) for row in record.static]
    parts.append(f'<polygon points="{_joined(lifts)}" fill="#cdd3da" fill-opacity=".55" stroke="none"/>')
    for curve in curves(record):
        parts += _curve(curve, most)
    words = "Least peak acceleration of the floor that overturns the statue, by direction of shaking, in every model."
    return _svg(SIZE, SIZE, words, parts)


def _svg(width: float, height: float, words: str, parts: Sequence[str], style: str = "") -> Markup:
    box = f'viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{escape(words)}"'
    return Markup(f'<svg class="still" {box}{style} xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>')


def _place(azimuth_deg: float, peak_g: float, most_g: float) -> tuple[float, float]:
    """Where a peak lies in the picture: x to the right, y of the statue's frame upwards."""
    r, angle = RADIUS * min(peak_g / most_g, 1.0), math.radians(azimuth_deg)
    return SIZE / 2.0 + r * math.cos(angle), SIZE / 2.0 - r * math.sin(angle)


def _joined(points: Sequence[tuple[float, float]]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _text(x: float, y: float, text: str, anchor: str = "middle", more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{escape(text)}</text>'


def _rings(most_g: float) -> list[str]:
    step = 0.2 if most_g > 0.6 else 0.1
    centre, parts = SIZE / 2.0, []
    values = [step * k for k in range(1, math.floor(most_g / step + 1e-9) + 1)]
    for value in values:
        r = RADIUS * value / most_g
        parts.append(f'<circle cx="{centre}" cy="{centre}" r="{r:.1f}" fill="none" stroke="{HAIRLINE}"/>')
    for azimuth in range(0, 360, 30):
        x, y = _place(azimuth, most_g, most_g)
        parts.append(f'<line x1="{centre}" y1="{centre}" x2="{x:.1f}" y2="{y:.1f}" stroke="{HAIRLINE}"/>')
        out = (x - centre) * 0.085, (y - centre) * 0.085
        parts.append(_text(x + out[0], y + out[1] + 4.0, f"{azimuth}°", more=f' fill="{MUTED}"'))
    x_axis, y_axis = _place(75.0, most_g, most_g)
    for value in values:
        x, y = centre + (x_axis - centre) * value / most_g, centre + (y_axis - centre) * value / most_g
        halo = ' stroke="#fff" stroke-width="3" paint-order="stroke"'
        parts.append(_text(x, y + 4.0, f"{value:.1f} g", more=f' fill="{MUTED}"{halo}'))
    return parts


def _base(record: EffectsRecord) -> str:
    """The footprint seen from above, not to the scale of the rings: which side is which."""
    outline = np.asarray(record.scene.statue.footprint_m, dtype=np.float64)[:, :2]
    scale = 0.26 * RADIUS / float(np.abs(outline).max())
    points = [(SIZE / 2.0 + scale * x, SIZE / 2.0 - scale * y) for x, y in outline]
    cross = f'<circle cx="{SIZE / 2}" cy="{SIZE / 2}" r="2.5" fill="{INK}"/>'
    return f'<polygon points="{_joined(points)}" fill="none" stroke="#6d6353" stroke-width="1.2"/>{cross}'


def _band(bands: Sequence[Band], most_g: float) -> list[str]:
    """At each direction a bar from the 5 % to the 95 % quantile of the drawn statues."""
    parts = []
    for row in bands:
        if row.low_g is None:
            continue
        (x1, y1), (x2, y2) = (
            _place(row.azimuth_deg, value if value is not None else most_g, most_g) for value in (row.low_g, row.high_g)
        )
        line = f'x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"'
        parts.append(f'<line {line} stroke="{INK}" stroke-opacity=".28" stroke-width="9"/>')
    return parts


def _curve(curve: Curve, most_g: float) -> list[str]:
    dash = "" if curve.dash == "solid" else f' stroke-dasharray="{curve.dash}"'
    style = f'fill="none" stroke="{curve.colour}" stroke-width="{curve.width:g}"{dash} stroke-linejoin="round"'
    places = [_place(azimuth, most_g if peak is None else peak, most_g) for azimuth, peak in curve.points]
    parts = [f'<polygon points="{_joined(places)}" {style}/>']
    for (azimuth, peak), (x, y) in zip(curve.points, places, strict=True):
        tip = f"{curve.name}, {azimuth:g}°: " + ("stands" if peak is None else f"{peak:.3f} g")
        fill = "#fff" if peak is None else curve.colour
        mark = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{fill}" stroke="{curve.colour}">'
        parts.append(f"{mark}<title>{escape(tip)}</title></circle>")
    return parts


def changes(record: EffectsRecord, words: Mapping[str, str]) -> Markup:
    """Each condition's change of the overturning amplitude: one dot for a direction, a bar for the median, by engine."""
    items = record.effects
    conditions = list(dict.fromkeys(item.condition for item in items))
    engines = list(dict.fromkeys(item.engine for item in items))
    values = [abs(change.relative) for item in items for change in item.changes]
    most = max(0.05, math.ceil(20.0 * float(np.quantile(values, 0.9))) / 20.0) if values else 0.05
    height = 46.0 + ROW * len(conditions)
    parts = [*_scale(most, height), _uncertainty(items, most, height)]
    for number, condition in enumerate(conditions):
        top = 34.0 + ROW * number
        parts.append(_text(LABELS - 12.0, top + 0.62 * ROW, words.get(condition, condition), "end"))
        parts.append(
            f'<line x1="0" x2="{WIDE}" y1="{top + ROW:g}" y2="{top + ROW:g}" stroke="{HAIRLINE}" opacity=".6"/>'
        )
        for item in items:
            if item.condition == condition:
                shift = (engines.index(item.engine) + 1.0) / (len(engines) + 1.0)
                parts += _dots(item, top + ROW * shift, most, look(item.engine, engines).colour)
    said = "Change of the overturning amplitude under each condition, in per cent, one dot for each direction."
    return _svg(WIDE, height, said, parts, ' style="min-width: 700px"')


def _x(relative: float, most: float) -> float:
    return LABELS + (WIDE - LABELS - RIGHT) * 0.5 * (1.0 + max(-1.0, min(1.0, relative / most)))


def _scale(most: float, height: float) -> list[str]:
    parts = []
    for k in range(-4, 5):
        value = most * k / 4.0
        x = _x(value, most)
        colour = MUTED if k == 0 else HAIRLINE
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="26" y2="{height - 12:g}" stroke="{colour}"/>')
        sign = "+" if value > 0 else "−" if value < 0 else ""
        parts.append(_text(x, 18.0, f"{sign}{abs(100.0 * value):g} %", more=f' fill="{MUTED}"'))
    return parts


def _uncertainty(items: Sequence[Effect], most: float, height: float) -> str:
    """The range in which a survey's and friction's errors move the amplitude: quantiles 5 and 95 % of those changes."""
    moved = [c.relative for item in items if item.group == "uncertainty" for c in item.changes]
    if not moved:
        return ""
    low, high = (_x(float(np.quantile(moved, q)), most) for q in (0.05, 0.95))
    return f'<rect x="{low:.1f}" y="26" width="{high - low:.1f}" height="{height - 38:g}" fill="{INK}" opacity=".07"/>'


def _dots(item: Effect, y: float, most: float, colour: str) -> list[str]:
    parts = []
    for change in item.changes:
        relative = change.relative
        x, tip = _x(relative, most), f"{item.engine}, {change.azimuth_deg:g}°: {100.0 * relative:+.1f} %"
        if abs(relative) > most:
            d = 5.0 if relative > 0 else -5.0
            mark = (
                f'<path d="M{x - d:.1f},{y - 4:.1f} L{x + d:.1f},{y:.1f} L{x - d:.1f},{y + 4:.1f} Z" fill="{colour}">'
            )
            parts.append(f"{mark}<title>{escape(tip)}</title></path>")
        else:
            mark = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}" fill-opacity=".5">'
            parts.append(f"{mark}<title>{escape(tip)}</title></circle>")
    if item.median is not None:
        x = _x(item.median, most)
        parts.append(
            f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{y - 5:.1f}" y2="{y + 5:.1f}" stroke="{colour}" stroke-width="3"/>'
        )
    return parts
