"""The pictures of an effects study: the rose of overturning amplitudes, and each condition's effect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from markupsafe import Markup

from harness.records.effects3d import BASELINE, Band, Effect, EffectsRecord
from reports.charts.palette import HAIRLINE, INK, MUTED, look
from reports.drawing.display_mesh import read_mesh
from reports.drawing.scan_picture import Figure, directions_picture
from reports.drawing.shapes import Disc, Path, Picture, Shape, Text, area, box, line, nice_ticks
from reports.source import RunSource

SIZE: Final = 640.0
RADIUS: Final = 275.0
WIDE: Final = 940.0
ROW: Final = 30.0
LABELS: Final = 300.0
"""Width of the conditions' names."""
RIGHT: Final = 40.0
"""Room beside the last mark of the scale, for its label."""
RINGS: Final = 6
"""Most rings of a rose."""
KEY_ROW: Final = 20.0
"""Height of a name in a rose's key."""
SIDES_COLOUR: Final = "#8a6d00"

Point = tuple[float, float | None]


@dataclass(frozen=True)
class Curve:
    """One curve of a rose: (azimuth in degrees, peak in g; None: it does not overturn up to the most tried)."""

    name: str
    points: Sequence[Point]
    colour: str
    dash: str
    width: float


def curves(record: EffectsRecord) -> list[Curve]:
    """The curves of a record: every engine's, and the planar model asked at the base's sides."""
    engines = record.engines
    drawn = []
    for name in engines[::-1]:
        points = [(row.azimuth_deg, row.peak_g) for row in record.amplitudes(name, BASELINE)]
        style = look(name, engines)
        drawn.append(Curve(name, points, style.colour, style.dash, style.width + 0.4))
    sides = [(row.azimuth_deg, row.projected_g) for row in record.static]
    return [*drawn, Curve("analytic, at the base's sides", sides, SIDES_COLOUR, "1.5 4", 2.6)]


def rose(record: EffectsRecord) -> Picture:
    """The least peak that overturns by direction; curves end on the rim where it does not overturn up to the most tried."""
    most = record.study.search.most_g
    lifts = [_place(row.azimuth_deg, row.lifts_g, most) for row in record.static]
    under = [*_base(record), *_band(record.bands, most), area(lifts, "#cdd3da", opacity=0.55)]
    return rose_of(curves(record), most, " g", under)


def rose_of(drawn: Sequence[Curve], most: float, unit: str, under: Sequence[Shape] = ()) -> Picture:
    """Curves by direction of shaking out to `most`, over the shapes `under` them, with a key below.

    Each joins neighbouring directions of all that were asked: what lies between others is not known.
    """
    shapes = [*_rings(most, unit), *under]
    asked = sorted({azimuth for curve in drawn for azimuth, _ in curve.points})
    for curve in drawn:
        shapes += _curve(curve, asked, most, unit)
    for k, curve in enumerate(drawn):
        y = SIZE + 12.0 + KEY_ROW * k
        shapes.append(line([(40.0, y), (72.0, y)], curve.colour, curve.width, _dash(curve)))
        shapes.append(Text(80.0, y + 4.0, curve.name, "start"))
    return Picture(SIZE, SIZE + KEY_ROW * len(drawn) + 8.0, shapes)


def _place(azimuth_deg: float, peak_g: float, most_g: float) -> tuple[float, float]:
    """Where a peak lies in the picture: x to the right, y of the statue's frame upwards."""
    r, angle = RADIUS * min(peak_g / most_g, 1.0), math.radians(azimuth_deg)
    return SIZE / 2.0 + r * math.cos(angle), SIZE / 2.0 - r * math.sin(angle)


def _rings(most_g: float, unit: str) -> list[Shape]:
    centre = SIZE / 2.0
    values = nice_ticks(0.0, most_g, RINGS)[1:]
    shapes: list[Shape] = [Disc(centre, centre, RADIUS * value / most_g, stroke=HAIRLINE) for value in values]
    for azimuth in range(0, 360, 30):
        x, y = _place(azimuth, most_g, most_g)
        shapes.append(line([(centre, centre), (x, y)], HAIRLINE))
        out = (x - centre) * 0.085, (y - centre) * 0.085
        shapes.append(Text(x + out[0], y + out[1] + 4.0, f"{azimuth}°", colour=MUTED))
    for value in values:
        x, y = _place(75.0, value, most_g)
        shapes.append(Text(x, y + 4.0, f"{value:g}{unit}", colour=MUTED, halo=True))
    return shapes


def _base(record: EffectsRecord) -> list[Shape]:
    """The footprint seen from above, not to the scale of the rings: which side is which."""
    outline = np.asarray(record.scene.statue.footprint_m, dtype=np.float64)[:, :2]
    scale = 0.26 * RADIUS / float(np.abs(outline).max())
    points = SIZE / 2.0 + scale * outline * [1.0, -1.0]
    return [area(points, "", "#6d6353", 1.2), Disc(SIZE / 2, SIZE / 2, 2.5, INK)]


def _band(bands: Sequence[Band], most_g: float) -> list[Shape]:
    """At each direction a bar from the 5 % to the 95 % quantile of the drawn statues."""
    return [
        line(
            [
                _place(row.azimuth_deg, value if value is not None else most_g, most_g)
                for value in (row.low_g, row.high_g)
            ],
            INK, 9.0, opacity=0.28,
        )
        for row in bands
        if row.low_g is not None
    ]  # fmt: skip


def _dash(curve: Curve) -> str:
    return curve.dash


def _curve(curve: Curve, asked: Sequence[float], most_g: float, unit: str) -> list[Shape]:
    places = {azimuth: _place(azimuth, most_g if peak is None else peak, most_g) for azimuth, peak in curve.points}
    whole = len(places) == len(asked)
    around = [places.get(azimuth, (math.nan, math.nan)) for azimuth in [*asked, *([] if whole else asked[:1])]]
    shapes: list[Shape] = [Path(np.array(around), curve.colour, curve.width, _dash(curve), closed=whole)]
    for azimuth, peak in curve.points:
        x, y = places[azimuth]
        tip = f"{curve.name}, {azimuth:g}°: " + ("stands" if peak is None else f"{peak:.3f}{unit}")
        shapes.append(Disc(x, y, 3.0, "#fff" if peak is None else curve.colour, curve.colour, title=tip))
    return shapes


def changes(record: EffectsRecord) -> Picture:
    """Each condition's change of the overturning amplitude: one dot for a direction, a bar for the median, by engine."""
    items = record.effects
    conditions = list(dict.fromkeys(item.condition for item in items))
    engines = list(dict.fromkeys(item.engine for item in items))
    values = [abs(change.relative) for item in items for change in item.changes]
    most = max(0.05, math.ceil(20.0 * float(np.quantile(values, 0.9))) / 20.0) if values else 0.05
    height = 46.0 + ROW * len(conditions)
    shapes = [*_scale(most, height), *_uncertainty(items, most, height)]
    for number, condition in enumerate(conditions):
        top = 34.0 + ROW * number
        shapes.append(Text(LABELS - 12.0, top + 0.62 * ROW, condition, "end"))
        shapes.append(line([(0.0, top + ROW), (WIDE, top + ROW)], HAIRLINE, opacity=0.6))
        for item in items:
            if item.condition == condition:
                shift = (engines.index(item.engine) + 1.0) / (len(engines) + 1.0)
                shapes += _dots(item, top + ROW * shift, most, look(item.engine, engines).colour)
    return Picture(WIDE, height, shapes)


def scan_figure(record: EffectsRecord, source: RunSource) -> Figure | None:
    """The scan turned back from the replay to the study's directions; None without a mesh, or where nothing overturns."""
    peaks = {
        row.azimuth_deg: row.peak_g
        for row in record.amplitudes(record.solid_engine, BASELINE)
        if row.peak_g is not None
    }
    if source.mesh is None or record.replay is None or not peaks:
        return None
    # A fifth of a second that every other page would pay for.
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_euler("z", record.replay.azimuth_deg, degrees=True)
    vertices, faces = read_mesh(source.mesh)
    footprint = turn.apply(np.asarray(source.scene.statue.footprint_m))
    return Figure(turn.apply(vertices), faces, footprint, min(peaks, key=lambda azimuth: peaks[azimuth]))


def directions(record: EffectsRecord, source: RunSource) -> Markup | None:
    """The scan with the rose's directions on the floor around it."""
    figure = scan_figure(record, source)
    if figure is None:
        return None
    words = "The scan, and the directions by their angles; the arrow points towards"
    return directions_picture(figure).svg(f"{words} {figure.weakest_deg:g}°.")


def _x(relative: float, most: float) -> float:
    return LABELS + (WIDE - LABELS - RIGHT) * 0.5 * (1.0 + max(-1.0, min(1.0, relative / most)))


def _scale(most: float, height: float) -> list[Shape]:
    shapes: list[Shape] = []
    for k in range(-4, 5):
        value = most * k / 4.0
        x, colour = _x(value, most), MUTED if k == 0 else HAIRLINE
        sign = "+" if value > 0 else "−" if value < 0 else ""
        shapes += [
            line([(x, 26.0), (x, height - 12.0)], colour),
            Text(x, 18.0, f"{sign}{abs(100.0 * value):g} %", colour=MUTED),
        ]
    return shapes


def _uncertainty(items: Sequence[Effect], most: float, height: float) -> list[Shape]:
    """The range in which a survey's and friction's errors move the amplitude: quantiles 5 and 95 % of those changes."""
    moved = [c.relative for item in items if item.group == "uncertainty" for c in item.changes]
    if not moved:
        return []
    low, high = (_x(float(np.quantile(moved, q)), most) for q in (0.05, 0.95))
    return [box(low, 26.0, high - low, height - 38.0, INK, 0.07)]


def _dots(item: Effect, y: float, most: float, colour: str) -> list[Shape]:
    shapes: list[Shape] = []
    for change in item.changes:
        relative = change.relative
        x, tip = _x(relative, most), f"{item.engine}, {change.azimuth_deg:g}°: {100.0 * relative:+.1f} %"
        if abs(relative) > most:
            d = 5.0 if relative > 0 else -5.0
            arrow = np.array([(x - d, y - 4.0), (x + d, y), (x - d, y + 4.0)])
            shapes.append(Path(arrow, fill=colour, closed=True, title=tip))
        else:
            shapes.append(Disc(x, y, 3.0, colour, opacity=0.5, title=tip))
    if item.median is not None:
        x = _x(item.median, most)
        shapes.append(line([(x, y - 5.0), (x, y + 5.0)], colour, 3.0))
    return shapes
