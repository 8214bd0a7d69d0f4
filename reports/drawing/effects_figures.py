"""The pictures of an effects study: the rose of overturning amplitudes, and each condition's effect."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from markupsafe import Markup

from harness.records.effects3d import BASELINE, Band, EffectsRecord
from reports.charts import Json
from reports.charts.figure import (
    HAIRLINE,
    HEIGHT,
    INK,
    MUTED,
    WIDTH,
    across,
    axis,
    figure,
    level,
    look,
    marks,
    named,
    span,
)
from reports.drawing.display_mesh import read_mesh
from reports.drawing.scan_picture import Figure, directions_picture
from reports.drawing.shapes import Disc, Path, Picture, Shape, Text, area, line, nice_ticks
from reports.messages import ENGLISH, Language
from reports.source import RunSource

SIZE: Final = 640.0
RADIUS: Final = 275.0
ROW: Final = 46.0
"""Height of a condition."""
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


def curves(record: EffectsRecord, say: Language = ENGLISH) -> list[Curve]:
    """The curves of a record: every engine's, and the planar model asked at the base's sides."""
    engines = record.engines
    drawn = []
    for name in engines[::-1]:
        points = [(row.azimuth_deg, row.peak_g) for row in record.amplitudes(name, BASELINE)]
        style = look(name, engines)
        drawn.append(Curve(name, points, style.colour, style.dash, style.width + 0.4))
    sides = [(row.azimuth_deg, row.projected_g) for row in record.static]
    return [*drawn, Curve(say("chart.at_sides"), sides, SIDES_COLOUR, "1.5 4", 2.6)]


def rose(record: EffectsRecord, say: Language = ENGLISH) -> Picture:
    """The least peak that overturns by direction; curves end on the rim where it does not overturn up to the most tried."""
    most = record.study.search.most_g
    lifts = [_place(row.azimuth_deg, row.lifts_g, most) for row in record.static]
    under = [*_base(record), *_band(record.bands, most), area(lifts, "#cdd3da", opacity=0.55)]
    return rose_of(curves(record, say), most, " g", under, say)


def rose_of(
    drawn: Sequence[Curve], most: float, unit: str, under: Sequence[Shape] = (), say: Language = ENGLISH
) -> Picture:
    """Curves by direction of shaking out to `most`, over the shapes `under` them, with a key below.

    Each joins neighbouring directions of all that were asked: what lies between others is not known.
    """
    shapes = [*_rings(most, unit), *under]
    asked = sorted({azimuth for curve in drawn for azimuth, _ in curve.points})
    for curve in drawn:
        shapes += _curve(curve, asked, most, unit, say)
    for k, curve in enumerate(drawn):
        y = SIZE + 12.0 + KEY_ROW * k
        shapes.append(line([(40.0, y), (72.0, y)], curve.colour, curve.width, curve.dash))
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


def _curve(curve: Curve, asked: Sequence[float], most_g: float, unit: str, say: Language) -> list[Shape]:
    places = {azimuth: _place(azimuth, most_g if peak is None else peak, most_g) for azimuth, peak in curve.points}
    whole = len(places) == len(asked)
    around = [places.get(azimuth, (math.nan, math.nan)) for azimuth in [*asked, *([] if whole else asked[:1])]]
    shapes: list[Shape] = [Path(np.array(around), curve.colour, curve.width, curve.dash, closed=whole)]
    for azimuth, peak in curve.points:
        x, y = places[azimuth]
        tip = f"{curve.name}, {azimuth:g}°: " + (say("ends.stands") if peak is None else f"{peak:.3f}{unit}")
        shapes.append(Disc(x, y, 3.0, "#fff" if peak is None else curve.colour, curve.colour, title=tip))
    return shapes


def changes(record: EffectsRecord, say: Language = ENGLISH) -> Json:
    """Each condition's change of the overturning amplitude: a disc for a direction, a stroke for the median, by engine.

    What lies beyond the axis stands at its end as a triangle; the field behind is how far errors of a survey move it.
    """
    items, conditions = record.effects, list(dict.fromkeys(item.condition for item in record.effects))
    engines = list(dict.fromkeys(item.engine for item in items))
    sizes = [abs(change.relative) for item in items for change in item.changes]
    most = max(5.0, 5.0 * math.ceil(20.0 * float(np.quantile(sizes, 0.9)))) if sizes else 5.0
    parts: list[Json] = []
    for item in items:
        at = conditions.index(item.condition) + (engines.index(item.engine) + 1.0) / (len(engines) + 1.0)
        percent = [100.0 * change.relative for change in item.changes]
        parts.append({
            "name": item.engine, "x": [max(-most, min(most, value)) for value in percent], "y": [at] * len(percent),
            "kind": ["within" if abs(value) <= most else "above" if value > 0.0 else "below" for value in percent],
            "tip": [
                f"{item.engine}, {each.azimuth_deg:g}°: {say.value(each.relative, 'points')}\u00a0%" for each in item.changes
            ],
            "median": None if item.median is None else 100.0 * item.median, "high": at - 0.2, "low": at + 0.2,
        })  # fmt: skip
    moved = [100.0 * c.relative for item in items if item.group == "uncertainty" for c in item.changes]
    field = (
        [dict(zip(("x", "x2"), ([float(np.quantile(moved, q))] for q in (0.05, 0.95)), strict=True))] if moved else []
    )
    names_of = {"words": [say.word(each) for each in conditions], "y": list(map(float, range(len(conditions))))}
    drawn = named({engine: look(engine, engines) for engine in engines}, legend=False, chosen=False)["color"]
    shapes = {"within": "circle", "above": "triangle-right", "below": "triangle-left"}
    shape = {
        "field": "kind",
        "type": "nominal",
        "legend": None,
        "scale": {"domain": [*shapes], "range": [*shapes.values()]},
    }
    layers = [
        marks("rect", "field", {"x2": {"field": "x2"}, "y": {"value": 0}, "y2": HEIGHT}, color=INK, opacity=0.07),
        marks("rule", "conditions", {"x": {"value": 0}, "x2": WIDTH}, color=HAIRLINE),
        *level(0.0, letter="x"),
        marks("point", "changes", {"fill": drawn, "shape": shape}, filled=True, size=40, opacity=0.5, strokeWidth=0),
        marks("rule", "changes", {"x": {"field": "median"}, **span("high", "low"), "color": drawn}, strokeWidth=3),
        marks("text", "conditions", {"x": {"value": 0}, "text": {"field": "words"}}, align="left", baseline="top", dy=4),
    ]  # fmt: skip
    x = across("x", say("chart.change"), {"domain": [-most, most], "padding": 0})
    y = axis("y", scale={"domain": [len(conditions), 0], "nice": False}, labels=False, ticks=False, grid=False)
    data = {"changes": parts, "field": field, "conditions": [names_of]}
    return figure(layers, ROW * len(conditions), data, x, y)


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


def directions(record: EffectsRecord, source: RunSource, say: Language) -> Markup | None:
    """The scan with the rose's directions on the floor around it."""
    figure = scan_figure(record, source)
    if figure is None:
        return None
    return directions_picture(figure).svg(say("scan.directions", towards=f"{figure.weakest_deg:g}"))
