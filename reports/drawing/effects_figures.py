"""The pictures of an effects study: the rose of overturning amplitudes, and each condition's effect."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from markupsafe import Markup

from harness.model import Array, rotations
from harness.records.effects3d import BASELINE, EffectsRecord
from reports.charts import Json
from reports.charts.figure import (
    HAIRLINE,
    HEIGHT,
    INK,
    MUTED,
    WIDTH,
    Look,
    across,
    axis,
    columns,
    figure,
    level,
    look,
    marks,
    named,
    span,
)
from reports.drawing.kinematics import Faces, read_mesh
from reports.drawing.scan_picture import directions_picture
from reports.drawing.shapes import Picture, disc, path, plane, polar, rings, text
from reports.messages import ENGLISH, Language
from reports.source import RunSource

SIZE: Final = 640.0
CENTRE: Final = (SIZE / 2.0, SIZE / 2.0)
RADIUS: Final = 275.0
ROW: Final = 46.0
"""Height of a condition."""
RINGS: Final = 6
"""Most rings of a rose."""
KEY_ROW: Final = 20.0
"""Height of a name in a rose's key."""
SIDES_COLOUR: Final = "#8a6d00"


@dataclass(frozen=True)
class RoseCurve:
    """One curve of a rose: the peak in g by azimuth in degrees (None: it does not overturn up to the most tried)."""

    name: str
    peaks: Mapping[float, float | None]
    look: Look


def curves(record: EffectsRecord, say: Language = ENGLISH) -> list[RoseCurve]:
    """The curves of a record: every engine's, and the planar model asked at the base's sides."""
    drawn = [
        RoseCurve(
            name, {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)}, look(name, record.engines)
        )
        for name in record.engines[::-1]
    ]
    sides = {row.azimuth_deg: row.projected_g for row in record.static}
    return [*drawn, RoseCurve(say("chart.at_sides"), sides, Look(SIDES_COLOUR, "1.5 4", 2.2))]


def rose(record: EffectsRecord, say: Language = ENGLISH) -> Picture:
    """The least peak that overturns by direction; curves end on the rim where it does not overturn up to the most tried.

    Under them the base, not to the scale of the rings, from which peak on it lifts, and at each direction a bar from the
    5 % to the 95 % quantile of the drawn statues.
    """
    most = record.study.search.most_g
    outline = np.asarray(record.scene.statue.footprint_m, dtype=np.float64)[:, :2]
    base = plane(0.26 * RADIUS / float(np.abs(outline).max()), (0.0, 0.0), CENTRE)
    lifts = _places({row.azimuth_deg: row.lifts_g for row in record.static}, most)
    bars = [
        [_places({row.azimuth_deg: value}, most)[0] for value in (row.low_g, row.high_g)]
        for row in record.bands
        if row.low_g is not None
    ]
    under = [
        path(base(outline), closed=True, stroke="#6d6353", width=1.2),
        disc(*CENTRE, 2.5, fill=INK),
        *(path(ends, stroke=INK, width=9, opacity=0.28) for ends in bars),
        path(lifts, closed=True, fill="#cdd3da", opacity=0.55),
    ]
    return rose_of(curves(record, say), most, " g", under, say)


def rose_of(
    drawn: Sequence[RoseCurve], most: float, unit: str, under: Sequence[str] = (), say: Language = ENGLISH
) -> Picture:
    """Curves by direction of shaking out to `most`, over the shapes `under` them, with a key below.

    Each joins neighbouring directions of all that were asked: what lies between others is not known.
    """
    asked = sorted({azimuth for curve in drawn for azimuth in curve.peaks})
    keys = [(SIZE + 12.0 + KEY_ROW * k, curve) for k, curve in enumerate(drawn)]
    shapes = [
        *_grid(most, unit, say),
        *under,
        *(shape for curve in drawn for shape in _curve(curve, asked, most, unit, say)),
        *(path([(40.0, y), (72.0, y)], **_style(curve)) for y, curve in keys),
        *(text(80.0, y + 4.0, curve.name, "start") for y, curve in keys),
    ]
    return Picture(SIZE, SIZE + KEY_ROW * len(drawn) + 8.0, shapes)


def _places(peaks: Mapping[float, float | None], most: float) -> Array:
    """Where peaks by azimuth lie in the picture: x to the right, y of the statue's frame upwards; the largest on the rim."""
    reach = {azimuth: most if peak is None else min(peak, most) for azimuth, peak in peaks.items()}
    return plane(RADIUS / most, (0.0, 0.0), CENTRE)(polar(reach))


def _style(curve: RoseCurve) -> dict[str, Any]:
    return {"stroke": curve.look.colour, "width": curve.look.width + 0.4, "dash": curve.look.dash}


def _grid(most: float, unit: str, say: Language) -> list[str]:
    """Rings at round values, and a line every 30 degrees."""
    values = rings(most, RINGS)
    rays = {azimuth: _places({azimuth: most}, most)[0] - CENTRE for azimuth in range(0, 360, 30)}
    names = {f"{azimuth}°": CENTRE + 1.085 * ray for azimuth, ray in rays.items()}
    told = {f"{say.short(value)}{unit}": _places({75.0: value}, most)[0] for value in values}
    return [
        *(disc(*CENTRE, RADIUS * value / most, stroke=HAIRLINE) for value in values),
        *(path([CENTRE, CENTRE + ray], stroke=HAIRLINE) for ray in rays.values()),
        *(text(x, y + 4.0, words, colour=MUTED) for words, (x, y) in names.items()),
        *(text(x, y + 4.0, words, colour=MUTED, halo=True) for words, (x, y) in told.items()),
    ]


def _curve(curve: RoseCurve, asked: Sequence[float], most: float, unit: str, say: Language) -> list[str]:
    places = {azimuth: (x, y) for azimuth, (x, y) in zip(curve.peaks, _places(curve.peaks, most).tolist(), strict=True)}
    whole = len(places) == len(asked)
    around = [places.get(azimuth, (math.nan, math.nan)) for azimuth in [*asked, *([] if whole else asked[:1])]]
    colour = curve.look.colour
    ends = {at: say("ends.stands") if peak is None else f"{say.digits(peak)}{unit}" for at, peak in curve.peaks.items()}
    tips = {at: f"{curve.name}, {say.short(at)}°: {end}" for at, end in ends.items()}
    return [
        path(around, closed=whole, **_style(curve)),
        *(
            disc(*places[at], 3.0, fill="#fff" if peak is None else colour, stroke=colour, title=tips[at])
            for at, peak in curve.peaks.items()
        ),
    ]


def changes(record: EffectsRecord, say: Language = ENGLISH) -> Json:
    """Each condition's change of the overturning amplitude: a disc for a direction, a stroke for the median, by engine.

    The axis holds every median; what lies beyond stands at its end as a triangle. The field behind is how far errors of a survey
    move it.
    """
    items, conditions = record.effects, list(dict.fromkeys(item.condition for item in record.effects))
    engines = list(dict.fromkeys(item.engine for item in items))
    sizes = [abs(change.relative) for item in items for change in item.changes]
    widest = max([float(np.quantile(sizes, 0.9)), *(abs(item.median or 0.0) for item in items)]) if sizes else 0.0
    most = max(5.0, 5.0 * math.ceil(20.0 * widest))
    parts: list[Json] = []
    for item in items:
        at = conditions.index(item.condition) + (engines.index(item.engine) + 1.0) / (len(engines) + 1.0)
        percent = [100.0 * change.relative for change in item.changes]
        parts.append({
            "name": item.engine, "x": [max(-most, min(most, value)) for value in percent], "y": [at] * len(percent),
            "kind": ["within" if abs(value) <= most else "above" if value > 0.0 else "below" for value in percent],
            "tip": [
                f"{item.engine}, {say.short(each.azimuth_deg)}°: {say.value(each.relative, 'points')}\u00a0%"
                for each in item.changes
            ],
            "median": None if item.median is None else 100.0 * item.median, "high": at - 0.2, "low": at + 0.2,
        })  # fmt: skip
    moved = [100.0 * c.relative for item in items if item.group == "uncertainty" for c in item.changes]
    field = [columns("x x2", [np.quantile(moved, (0.05, 0.95)).tolist()])] if moved else []
    names_of = columns("words y", [(say.word(each), float(k)) for k, each in enumerate(conditions)])
    drawn = named({engine: look(engine, engines) for engine in engines}, legend=False, chosen=False)["color"]
    shapes = {"within": "circle", "above": "triangle-right", "below": "triangle-left"}
    scale = {"domain": [*shapes], "range": [*shapes.values()]}
    shape = {"field": "kind", "type": "nominal", "legend": None, "scale": scale}
    layers = [
        marks("rect", "field", {"x2": {"field": "x2"}, "y": {"value": 0}, "y2": HEIGHT}, color=INK, opacity=0.07),
        marks("rule", "conditions", {"x": {"value": 0}, "x2": WIDTH}, color=HAIRLINE),
        *level(0.0, letter="x"),
        marks("point", "changes", {"fill": drawn, "shape": shape}, filled=True, size=40, opacity=0.5, strokeWidth=0, clip=False),
        marks("rule", "changes", {"x": {"field": "median"}, **span("high", "low"), "color": drawn}, strokeWidth=3),
        marks("text", "conditions", {"x": {"value": 0}, "text": {"field": "words"}}, align="left", baseline="top", dy=4),
    ]  # fmt: skip
    x = across("x", say("chart.change"), {"domain": [-most, most], "padding": 0})
    y = axis("y", scale={"domain": [len(conditions), 0], "nice": False}, labels=False, ticks=False, grid=False)
    data = {"changes": parts, "field": field, "conditions": [names_of]}
    return figure(layers, ROW * len(conditions), data, x, y)


def turned_scan(record: EffectsRecord, source: RunSource) -> tuple[Array, Faces, Array, float] | None:
    """The scan turned back from the replay to the study's directions: vertices, faces, base, and the direction that falls first.

    None without a mesh, or where nothing overturns.
    """
    rows = record.amplitudes(record.solid_engine, BASELINE)
    peaks = {row.azimuth_deg: row.peak_g for row in rows if row.peak_g is not None}
    if source.mesh is None or record.replay is None or not peaks:
        return None
    turn = rotations({"pitch_rad": 0.0, "roll_rad": 0.0, "yaw_rad": math.radians(record.replay.azimuth_deg)})
    vertices, faces = read_mesh(source.mesh)
    footprint = np.asarray(source.scene.statue.footprint_m)
    return vertices @ turn.T, faces, footprint @ turn.T, min(peaks, key=lambda azimuth: peaks[azimuth])


def directions(record: EffectsRecord, source: RunSource, say: Language) -> Markup | None:
    """The scan with the rose's directions on the floor around it; None without one."""
    scan = turned_scan(record, source)
    return None if scan is None else directions_picture(*scan).svg(say("scan.directions", towards=say.short(scan[-1])))
