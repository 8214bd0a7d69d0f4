"""Parts of which every chart is made, and how one is drawn: a chart is a Vega-Lite specification.

Its `datasets` hold, by name, lists of parts; a part holds columns of one length, and single values that stand in each of its
rows. Columns that are arrays are the samples of curves along the first of them, of which as many are drawn as are seen.
"""

import errno
import re
import resource
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from textwrap import wrap
from typing import Any, Final

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from harness.model import Array, printable_lines, to_plain
from harness.records.scores import Interval
from reports.messages import Language

Json = dict[str, Any]
"""A chart, or a part of one, as its library takes it: which keys it knows is the library's."""

# Colours and dashes of all pages and figures: Okabe and Ito's palette, told apart by every form of colour vision.

INK: Final = "#1c2430"
MUTED: Final = "#566070"
HAIRLINE: Final = "#d5dbe3"

DARK: Final = {
    INK: "#e4e8ee", MUTED: "#a5b0bf", HAIRLINE: "#3a4553", "#0072b2": "#4ba6e0", "#d55e00": "#f58231", "#009e73": "#2fc79b",
    "#56616f": "#9fabba", "#3a8fc7": "#6fb8e6", "#b07c00": "#d9a520", "#aa4499": "#d77fca", "#c2185b": "#ff7aa8",
    "#0b6e4f": "#3fc18d", "#8c1d2f": "#ff8a96", "#8a6d00": "#d0aa2a", "#59636f": "#8793a3", "#6d6353": "#b3a78f",
    "#dfd8cb": "#5d574b", "#e3e6ea": "#4a5563", "#fff": "#1a2028",
}  # fmt: skip
"""What stands for a colour of lines and texts where the reader's screen is dark: each at least as far from its ground."""

SURFACES: Final = {
    "#e3e6eb": "#4a5563", "#56a8e0": "#0a4a8a", "#bfdef2": "#3a6f92", "#f0b03d": "#8a5f00", "#cc79a8": "#7d3270",
    "#f3e96b": "#6f681a", "#e0566b": "#9c2236", "#8f949b": "#000000",
}  # fmt: skip
"""Colours of the classes of a map and, where the reader's screen is dark, of each: lines run over them, and none is a line's."""


def dark_css() -> str:
    """Rules that turn the colours of pictures and keys on a dark screen; print stays light."""
    rules = []
    for light, dark in (DARK | SURFACES).items():
        rules += [f'svg [{part}="{light}" i]{{{part}:{dark}}}' for part in ("fill", "stroke")]
        if len(light) == len(INK):  # shorter ones begin others
            rules.append(f'[style*="--c: {light}" i]{{--c:{dark}!important}}')
    return f"@media screen and (prefers-color-scheme:dark){{{''.join(rules)}}}"


@dataclass(frozen=True)
class Look:
    """How a line is drawn everywhere: colour, lengths of dashes and gaps in pixels (empty: unbroken), width in pixels."""

    colour: str
    dash: str = ""
    width: float = 1.6

    @property
    def lengths(self) -> list[float]:
        """The lengths of dashes and gaps in pixels."""
        return [float(part) for part in self.dash.split()]


LOOKS: Final = {
    "analytic": Look(INK, "", 2.4),
    "pymunk": Look("#0072B2", "", 1.6),
    "pybullet": Look("#D55E00", "7 2", 1.6),
    "spatial": Look("#56616F", "6 2 1 2", 2.0),
    "pymunk:plain": Look("#3A8FC7", "3 3", 1.4),
    "pybullet:plain": Look("#B07C00", "9 3 2 3", 1.4),
}
SPARE: Final = (Look("#AA4499", "9 3 2 3", 1.6), Look("#B07C00", "4 3", 1.6), Look("#3A8FC7", "", 1.2))

FLOOR_COLOUR: Final = "#0072B2"
PEDESTAL_COLOUR: Final = "#D55E00"

PATTERN_COLOURS: Final = {
    "rest": "#e3e6ea", "rocking": "#56B4E9", "sliding": "#E69F00", "both": "#AA4499", "statue_slides": "#D55E00",
}  # fmt: skip
"""Colour of each motion pattern (docs/model.md, section 6); sliding is hatched, both crosswise."""
PATTERN_FILLS: Final = {**PATTERN_COLOURS, "sliding": "url(#hatch-sliding)", "both": "url(#hatch-both)"}
HATCHES: Final = "".join(
    f'<pattern id="hatch-{name}" width="6" height="6" patternUnits="userSpaceOnUse"><rect width="6" height="6" '
    f'fill="{PATTERN_COLOURS[name]}"/><path d="{lines}" stroke="#ffffff" stroke-width="1"/></pattern>'
    for name, lines in {"sliding": "M-1 1L1-1M0 6L6 0M5 7L7 5", "both": "M0 6L6 0M0 0L6 6"}.items()
)
"""What those fills call: lines in white, which tell patterns apart where colours do not."""


def look(name: str, names: list[str] | tuple[str, ...]) -> Look:
    """The look of a model; models without one of their own take spare looks in their order among `names`."""
    if name in LOOKS:
        return LOOKS[name]
    others = [item for item in names if item not in LOOKS]
    return SPARE[others.index(name) % len(SPARE)]


def model_looks(models: Sequence[str]) -> dict[str, Look]:
    """The looks of a study's models, `engine (variant)`: an engine's own, a spare one for each where it stands for several."""
    engines = [model.partition(" (")[0] for model in models]
    own = [engine if engines.count(engine) == 1 else model for model, engine in zip(models, engines, strict=True)]
    return {model: look(name, list(models)) for model, name in zip(models, own, strict=True)}


LETTER: Final = 7.2
"""Width of a letter of the charts' type in pixels, on average."""
ZOOMED: Final = [{"name": name, "value": None} for name in "XY"]
"""What a page zooms by: the stretch of each axis that is shown, all of it where there is none."""
CHOSEN: Final = {"name": "chosen", "select": {"type": "point", "fields": ["name"]}, "bind": "legend"}
"""Which names are chosen in the legend; the others stand back."""


def choice(name: str, words: str, known: Sequence[Any], value: Any = None) -> Json:
    """What a page's reader chooses of the known values; default: the first."""
    shown = {"input": "select", "options": list(known), "name": f"{words} "}
    return {"name": name, "value": known[0] if value is None else value, "bind": shown}


DASHED: Final = Look(MUTED, "6 4", 1.0)
"""A line of reference."""


def axis(field: str, title: str = "", zoom: str = "", scale: Json | None = None, **more: Any) -> Json:
    """An axis of numbers with its grid; `zoom` names the parameter that zooms it, `more` is the library's own of an axis."""
    zero = {} if scale and scale.get("type") == "log" else {"zero": False}
    shown = {**zero, **(scale or {}), **({"domainRaw": {"expr": zoom}} if zoom else {})}
    return {"field": field, "type": "quantitative", "title": title or None, "scale": shown, "axis": more}


def across(field: str, title: str = "", scale: Json | None = None, **more: Any) -> Json:
    """The level axis of a chart."""
    return axis(field, title, "X", {"nice": False, "padding": 8, **(scale or {})}, **more)


def upwards(field: str, title: str = "", scale: Json | None = None, **more: Any) -> Json:
    """The upright axis of a chart."""
    return axis(field, title, "Y", scale, **more)


def log(**more: Any) -> Json:
    """A logarithmic scale."""
    return {"type": "log", **more}


def names(field: str, order: Sequence[str], title: str = "", **more: Any) -> Json:
    """An axis of names in their order."""
    return {
        "field": field,
        "type": "nominal",
        "title": title or None,
        "sort": list(order),
        "axis": {"labelLimit": 0, **more},
    }


def kinds(colours: Mapping[str, str]) -> Json:
    """The colour of each kind of area, with a key in their order."""
    scale = {"domain": list(colours), "range": list(colours.values())}
    legend = {"symbolType": "square", "symbolStrokeWidth": 0, **wrapped(colours)}
    return {"field": "kind", "type": "nominal", "scale": scale, "legend": legend}


def wrapped(words: Iterable[str]) -> Json:
    """As many columns of a key as fit the chart's width `W`."""
    return {"columns": {"expr": f"max(1, floor((W - 80) / {50 + LETTER * max(map(len, words), default=1):.0f}))"}}


def named(looks: Mapping[str, Look], legend: bool = True, chosen: bool = True) -> Json:
    """How the lines and signs of each name are drawn, with a key of them over the chart, of which some may be chosen."""
    key = {"symbolType": "stroke", "symbolSize": 300, "labelOffset": 8, **wrapped(looks)} if legend else None
    ranges: dict[str, list[Any]] = {
        "color": [each.colour for each in looks.values()],
        "strokeDash": [each.lengths or [1, 0] for each in looks.values()],
        "strokeWidth": [each.width for each in looks.values()],
    }
    field = {"field": "name", "type": "ordinal", "legend": key}
    channels: Json = {name: field | {"scale": {"domain": list(looks), "range": each}} for name, each in ranges.items()}
    if len(looks) == 1:  # a key of one name has no room for what more it says
        channels |= {name: {"value": ranges[name][0]} for name in ("strokeDash", "strokeWidth")}
    return channels | ({"opacity": {"condition": {"param": "chosen", "value": 1}, "value": 0.12}} if chosen else {})


def marks(kind: str, data: str = "", encoding: Json | None = None, **more: Any) -> Json:
    """A layer of signs of one kind, of what stands in the data of that name; `more` is the library's own of a mark."""
    drawn: Json = {"mark": {"type": kind, "clip": True, **more}}
    return drawn | ({"data": {"name": data}} if data else {}) | ({"encoding": encoding} if encoding else {})


def span(low: str, high: str, letter: str = "y") -> Json:
    """From one column to another along an axis: bars of intervals, bands."""
    return {letter: {"field": low}, f"{letter}2": {"field": high}}


HEIGHT: Final = {"value": "height"}
"""The foot of a plot."""
WIDTH: Final = {"value": "width"}
"""The right side of a plot."""
FIRST: Final = {"value": 0}
"""The left side of a plot, and its top."""
LATE: Final = "scale('x', datum.at) > 0.6 * width"
"""Of a line far to the right the words stand before it."""
LEVELS: Final[Mapping[str, tuple[Json, Json, Json]]] = {
    "y": ({"x": FIRST, "x2": WIDTH}, {"x": WIDTH}, {"align": "right", "baseline": "bottom"}),
    "x": (
        {"y": FIRST, "y2": HEIGHT},
        {"y": FIRST},
        {
            "align": {"expr": f"{LATE} ? 'right' : 'left'"},
            "baseline": "top",
            "dx": {"expr": f"{LATE} ? -4 : 4"},
            "opacity": {"expr": "inrange(scale('x', datum.at), [0, width]) ? 1 : 0"},
        },
    ),
}
"""Of a line at a place of an axis: across the plot, where its words stand, and how: whole, or not at all."""


def level(
    at: float, words: str = "", letter: str = "y", line: Look = DASHED, ends: Json | None = None, **text: Any
) -> list[Json]:
    """A line across the whole chart at a place of an axis, with small words at its end, or where `ends` says."""
    there = {"data": {"values": [{"at": at, "words": words}]}}
    place: Json = {letter: {"field": "at", "type": "quantitative"}}
    whole, end, side = LEVELS[letter]
    drawn = there | marks("rule", "", place | whole, **stroke(line))
    said = place | (ends or end) | {"text": {"field": "words"}}
    written = marks("text", "", said, color=MUTED, fontSize=11, **(side | text))
    return [drawn, *([there | written] if words else [])]


def stroke(style: Look) -> Json:
    """A line drawn as a look says, as the library says it of a mark."""
    return {"color": style.colour, "strokeWidth": style.width, **({"strokeDash": style.lengths} if style.dash else {})}


def figure(
    layers: Sequence[Json], height: float, data: Mapping[str, Sequence[Json]], x: Json, y: Json, **more: Any
) -> Json:
    """A chart of one pair of axes over named data: each a list of columns of one length, single values beside them."""
    return {
        "datasets": dict(data), "params": [*ZOOMED], "height": height, "width": 1, "encoding": {"x": x, "y": y},
        "layer": list(layers), **more,
    }  # fmt: skip


def chosen(layers: Sequence[Json]) -> list[Json]:
    """Layers of which the first carries the legend's choice."""
    first, *rest = layers
    return [first | {"params": [CHOSEN]}, *rest]


def points(data: str, looks: Mapping[str, Look], y: Json, first: bool, joined: bool = True) -> list[Json]:
    """A disc at each point, `joined` by lines from left to right; the first row of several carries the key."""
    drawn = {"y": y} | named(looks, legend=first)
    # Over an axis of names the library would join the points by name. Points of no size carry the key alone.
    line = marks("line", data, drawn, orient="vertical") if joined else marks("point", data, drawn, size=0)
    return [*(chosen([line]) if first else [line]), discs(data, {"y": y} | filled(drawn))]


def filled(drawn: Json) -> Json:
    """Signs in the colours of lines, of which the legend's choice stands out where it does in them."""
    return {{"color": "fill"}.get(key, key): drawn[key] for key in ("color", "opacity") if key in drawn}


def discs(data: str, encoding: Json, **more: Any) -> Json:
    """A disc at each point."""
    return marks("point", data, encoding, **{"filled": True, "size": 40, "opacity": 1, "strokeWidth": 0, **more})


def estimates(data: str, drawn: Json, letter: str = "y") -> list[Json]:
    """Discs with the intervals of their estimates: columns `low` and `high`."""
    bar = span("low", "high", letter) | {key: drawn[key] for key in ("color", "opacity") if key in drawn}
    return [marks("rule", data, bar, strokeWidth=1.2), discs(data, filled(drawn))]


def band(data: str, drawn: Json, opacity: float) -> Json:
    """The area between the columns `low` and `high`, in the colour of its name."""
    return marks("area", data, span("low", "high") | {"fill": drawn["color"]}, fillOpacity=opacity)


def columns_of(values: Sequence[Interval], factor: float = 1.0, letter: str = "y") -> Json:
    """The columns of estimates with their intervals, in units of one `factor`-th."""
    return {
        letter: [factor * item.value for item in values], "low": [factor * item.low for item in values],
        "high": [factor * item.high for item in values],
    }  # fmt: skip


LOOKING: Final = ("color", "fill", "strokeDash", "strokeWidth", "shape")
"""Scales of which charts that stand together each have their own."""


def rows_of(rows: Sequence[tuple[Sequence[Json], float]], x: Json, data: Mapping[str, Sequence[Json]]) -> Json:
    """Rows over one level axis, each of its layers and its height; the axis is named below the last."""
    unnamed = x | {"title": None, "axis": x["axis"] | {"labels": False, "ticks": False}}
    made: list[Json] = [
        {"layer": list(layers), "height": height, "width": 1, "encoding": {"x": unnamed}} for layers, height in rows
    ]
    made[-1]["encoding"] = {"x": x}
    return {
        "datasets": dict(data), "params": [*ZOOMED], "vconcat": made, "spacing": 12,
        "resolve": {"scale": dict.fromkeys(LOOKING, "independent") | {"x": "shared"}},
    }  # fmt: skip


Row = tuple[list[Json], float, Json | None]
"""A row over time: its layers, its height, and what a pointer is told there."""


def over_time(rows: Sequence[Row], title: str, data: Mapping[str, Sequence[Json]], views: Json) -> Json:
    """Rows over time, which open on the event of `views`."""
    x = across("t", title, {"domain": views["event_s"], "padding": 0})
    drawn = rows_of([(layers, height) for layers, height, _ in rows], x, data)
    return drawn | {"usermeta": {"views": views, "read": [read for *_, read in rows]}}


def reading(data: str, column: str, words: str, unit: str, decimals: int) -> Json:
    """What a pointer over a row of curves is told at its time: of each curve its value, in these words."""
    return {"data": data, "of": column, "words": words, "unit": unit, "decimals": decimals}


def columns(keys: str, rows: Iterable[Sequence[Any]]) -> Json:
    """Rows of values as columns of these names."""
    listed = list(rows)
    return {key: [row[k] for row in listed] for k, key in enumerate(keys.split())}


def cells(xs: Sequence[float], ys: Sequence[float], kinds_of: Iterable[Sequence[Any]]) -> Json:
    """The cells of a map between the bounds of its columns and rows as columns `x`, `x2`, `y`, `y2`, `kind`.

    Neighbours of a row that are of one kind are one; those of none are left out.
    """
    found: list[tuple[Any, ...]] = []
    for i, row in enumerate(kinds_of):
        j = 0
        for kind, alike in groupby(row):
            end = j + len(list(alike))
            if kind is not None:
                found.append((xs[j], xs[end], ys[i], ys[i + 1], kind))
            j = end
    return columns("x x2 y y2 kind", found)


CELL: Final = {"x2": {"field": "x2"}, "y2": {"field": "y2"}}
"""How far a cell reaches."""
GRID: Final = {"condition": {"test": "datum.value === 0", "value": MUTED}, "value": HAIRLINE}
"""The colour of an upright axis' grid, nought seen."""
NUMBERS: Final = {"decimal": ".", "thousands": "", "grouping": [3], "currency": ["", ""]}
"""How charts write numbers: as the pages around them do."""
CONFIG: Final = {
    "aria": False,
    "locale": {"number": NUMBERS},
    "background": "transparent",
    "font": "sans-serif",
    "padding": {"left": 4, "right": 14, "top": 6, "bottom": 4},
    "axis": {
        "labelColor": INK, "titleColor": INK, "gridColor": HAIRLINE, "domain": False, "tickColor": HAIRLINE, "labelFontSize": 12,
        "titleFontSize": 13, "titleFontWeight": "normal", "labelOverlap": True, "labelSeparation": 6,
    },
    "axisY": {"gridColor": GRID},
    "legend": {
        "orient": "top", "offset": 8, "title": None, "labelColor": INK, "labelFontSize": 13, "labelLimit": 0,
        "direction": "horizontal",
        "titleColor": INK, "titleFontWeight": "normal", "columnPadding": 16,
        "layout": {"top": {"direction": "vertical", "anchor": "start"}},
    },
    "header": {"labelColor": INK, "labelFontSize": 12, "title": None, "labelFontWeight": "normal"},
    "title": {"color": INK, "fontSize": 13, "fontWeight": "normal", "anchor": "start", "offset": 8, "subtitleColor": MUTED},
    "text": {"color": INK, "fontSize": 12},
    "view": {"stroke": None},
}  # fmt: skip
"""How all charts look."""


def localised(spec: Json, say: Language) -> Json:
    """A chart whose numbers are written as that language writes them."""
    return spec | {"config": {"locale": {"number": NUMBERS | {"decimal": say.strings["decimal"]}}}}


# Samples as a page carries them: fewer for the screen with every peak kept, packed as differences of multiples of a step.

DISPLAYED_SAMPLES: Final = 12_000
"""Most samples of one curve on a page: a 10 s history at 1 ms stays whole, and four curves stay under 0.5 MB."""

STEPS: Final = 2**18
"""Steps over an array's range: a value on a page is at most a 500 000th of the range beside the record's."""
ON_CLOCK: Final = 1e-3
"""Samples this near to multiples of their spacing, as a share of it, are taken as such: times cost nothing then."""


def shown_samples(values: Array, most: int = DISPLAYED_SAMPLES) -> NDArray[np.intp]:
    """Indices of the samples to draw, increasing: all, or first, least, largest and last of every bin.

    At most `most` (≥ 8) are kept; the extremes of `values` and both its ends are always among them.
    """
    count = len(values)
    if count <= most:
        return np.arange(count)
    edges = np.linspace(0, count, most // 4 + 1).astype(np.intp)
    starts, ends = edges[:-1], edges[1:]
    chosen = [starts, ends - 1]
    width = int((ends - starts).max())
    padded = starts[:, None] + np.minimum(np.arange(width), (ends - starts)[:, None] - 1)
    block = values[padded]
    chosen += [starts + np.argmin(block, axis=1), starts + np.argmax(block, axis=1)]
    return np.unique(np.concatenate(chosen))


def packed_array(values: ArrayLike, levels: int = STEPS) -> Json:
    """Finite values (n,) or, flattened, (n, k) as `{step, order, deltas}`: `deltas` summed `order` times, times `step`.

    Whole numbers, and times on a clock, come back as they are.
    """
    array = np.asarray(values).ravel()
    step = 1.0 if array.dtype.kind in "iu" else _step(array.astype(np.float64), levels)
    steps = np.round(array / step).astype(np.int64)
    first = np.diff(steps, prepend=0)
    second = np.diff(first, prepend=0)
    order, deltas = min((1, first), (2, second), key=lambda choice: int(np.abs(choice[1]).sum()))
    return {"step": step, "order": order, "deltas": deltas.tolist()}


def _step(array: Any, levels: int) -> float:
    """The spacing of samples on a clock, for others the range over `levels`."""
    apart = np.diff(array)
    spacing = float(np.median(apart)) if len(apart) else 0.0
    # Beside a value that dwarfs it a spacing counts nothing: whole numbers end at 2^53.
    if 0.0 < np.abs(array).max(initial=0.0) < 2.0**53 * spacing:
        # A clock's spacing has few digits; a median of differences carries their rounding.
        spacing = float(f"{spacing:.9g}")
        if np.abs(array / spacing - np.round(array / spacing)).max() < ON_CLOCK:
            return spacing
    if len(array) < 2 or np.ptp(array) == 0.0:
        # One value, or the same again and again, is a multiple of itself.
        return float(abs(array[0])) if len(array) and array[0] else 1.0
    # Values that differ by their rounding alone: a finer step than that has no whole number of steps.
    return max(float(np.ptp(array)) / levels, float(np.spacing(np.abs(array).max())))


# Drawn by the library that made their form: on a page by its own script, as SVG, PNG and PDF without a browser.

WIDE: Final = 1060
"""Width in pixels of a chart that fills the page."""
POINTS: Final = 1200
"""Most points of a curve: more than pixels across."""
BETWEEN: Final = 24
"""Pixels between plots side by side."""
BESIDE: Final = 132
"""Pixels beside the plot of a chart of several, for the names of its axes: the longest outcome's in either language."""
RESERVED: Final = 68 * 2**30
"""Bytes of addresses, not of memory, that the library's engine reserves; where it may not, it ends the process."""
CUT: Final = re.compile(r"(?<=[\"#])clip\d+(?=[\")])")
"""What the library calls the outlines at which it cuts."""
TAG: Final = re.compile(r"<[^>]*>")
"""Where places stand; what is written between tags keeps its digits."""
FINER: Final = re.compile(r"(?<=\d\.\d)\d+")
"""Digits of a place in pixels after the first behind the point."""


def thinned(part: Json, most: int) -> Json:
    """A part with as many samples of its curves as are seen of so many points, every peak among them."""
    curves = [value for value in part.values() if isinstance(value, np.ndarray)]
    if not curves:
        return part
    shown = np.unique(np.concatenate([shown_samples(each, most) for each in curves[1:]]))
    return {key: value[shown] if isinstance(value, np.ndarray) else value for key, value in part.items()}


def rows(parts: Iterable[Json], most: int, chosen: Json) -> list[Json]:
    """The rows of a chart's data as the library takes them; of curves at most so many, with every peak.

    Parts that a parameter names otherwise than `chosen` are left out.
    """
    found = []
    for part in parts:
        if any(part.get(name, value) != value for name, value in chosen.items()):
            continue
        shown = to_plain(thinned(part, most))
        listed = {key: value for key, value in shown.items() if isinstance(value, list)}
        alike = {key: value for key, value in shown.items() if key not in listed}
        found += [alike | dict(zip(listed, each, strict=True)) for each in zip(*listed.values(), strict=True)]
    return found


def packed_data(data: Mapping[str, Sequence[Json]]) -> Json:
    """A chart's data as a page carries them: samples thinned and packed, all else as it is."""
    return {
        name: [
            {key: packed_array(value) if isinstance(value, np.ndarray) else value for key, value in part.items()}
            for part in (thinned(each, DISPLAYED_SAMPLES) for each in parts)
        ]
        for name, parts in data.items()
    }


def sized(spec: Any, width: float, alone: bool = True) -> Any:
    """A chart as wide as that: of several plots each has the share that it states, less the room for the names of axes."""
    if isinstance(spec, list):
        return [sized(each, width, False) for each in spec]
    if "autosize" in spec:
        return spec
    if "spec" in spec:
        return spec | {"spec": spec["spec"] | {"width": max(60.0, (width - BESIDE) / spec["columns"] - BETWEEN)}}
    parted = spec.keys() & {"vconcat", "hconcat"}
    if parted:
        return spec | {key: sized(spec[key], width, False) for key in parted}
    if alone:
        return spec | {"width": width, "autosize": {"type": "fit-x", "contains": "padding"}}
    return spec | {"width": max(60.0, spec["width"] * width - BESIDE)}


def svg(
    spec: Json,
    width: float = WIDE,
    most: int = POINTS,
    words: str = "",
    background: str = "transparent",
    name: str = "",
) -> str:
    """The chart as SVG that many pixels wide, `words` over it; by its `name` its ids are told apart from another's of a page.

    Raises `OSError` where addresses are limited to too few.
    """
    import vl_convert

    if 0 <= resource.getrlimit(resource.RLIMIT_AS)[0] < RESERVED:
        raise OSError(
            errno.ENOMEM, f"charts take {RESERVED // 2**30} GiB of addresses: give `ulimit -v unlimited` before"
        )
    chosen = {each["name"]: each["value"] for each in spec["params"] if "bind" in each and "value" in each}
    data = {name: rows(parts, most, chosen) for name, parts in spec["datasets"].items()}
    over = {"title": wrap(words, max(20, int((width - 16.0) / LETTER)))} if words else {}
    params = [*({key: value for key, value in each.items() if key != "bind"} for each in spec["params"])]
    params.append({"name": "W", "value": width})
    whole = (
        sized(spec, width)
        | {"datasets": data, "config": {**CONFIG, **spec.get("config", {}), "background": background}, "params": params}
        | over
    )
    drawn = str(vl_convert.vegalite_to_svg(legible(whole)))
    # The library counts what cuts over all that it ever drew.
    order = {found: f"cut{k}{name}" for k, found in enumerate(dict.fromkeys(CUT.findall(drawn)))}
    return CUT.sub(lambda found: order[found[0]], drawn)


def legible(part: Any) -> Any:
    """A chart, or a part of one, with the control characters of its texts, which would stop the library, as their escapes."""
    if isinstance(part, dict):
        return {legible(key): legible(value) for key, value in part.items()}
    if isinstance(part, list):
        return [legible(value) for value in part]
    return printable_lines(part) if isinstance(part, str) else part


def hatched(drawn: str) -> str:
    """An SVG with the hatches that its fills call."""
    return drawn.replace(">", f"><defs>{HATCHES}</defs>", 1) if "url(#hatch" in drawn else drawn


def still(spec: Json, width: float = WIDE, name: str = "") -> Markup:
    """The chart as a page carries it under its `name`: what is seen first and without scripts, and what is printed; before it
    what both call."""
    drawn = TAG.sub(lambda tag: FINER.sub("", tag[0]), svg(spec, width, name=name))
    box = drawn.index("viewBox=")
    called = f'<svg class="called" aria-hidden="true"><defs>{HATCHES}</defs></svg>' if "url(#hatch" in drawn else ""
    return Markup(f'{called}<svg class="still" aria-hidden="true" xmlns="http://www.w3.org/2000/svg" {drawn[box:]}')
