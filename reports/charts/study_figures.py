"""The pictures that a study's rows hold: the paper's panels, fragility, roses."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from harness.comparison.statistics import fit_fragility, wilson
from harness.model import Finding, grouped, info
from harness.records.run import STILL_RAD, falls
from harness.records.study import CaseRun, Panel
from harness.statics.standstill import STILL_M
from reports.charts import Json
from reports.charts.drawn import BETWEEN
from reports.charts.figure import (
    FLOOR_COLOUR,
    INK,
    PEDESTAL_COLOUR,
    ZOOMED,
    Look,
    across,
    axis,
    band,
    choice,
    chosen,
    columns,
    columns_of,
    estimates,
    figure,
    marks,
    model_looks,
    named,
    names,
    points,
    rows_of,
    upwards,
)  # fmt: skip
from reports.charts.map_figures import number_map
from reports.drawing.effects_figures import RoseCurve, rose_of
from reports.drawing.shapes import Picture
from reports.messages import ENGLISH, Language
from reports.text.answers import LEAST, Answers
from reports.text.wording import told_family, told_symbol

# Maps of numbers: how far the statue rotates and its pedestal slides over what varies, and where the pedestal would tip.

MOST_PLACES: Final = 10_000
"""Larger maps show where the statue falls only: a number for every place would make the page large."""
TIPPING: Final = ("pedestal_tipping_margin_m", "pedestal_tipping_margin_at_impact_m")
"""The margins of the record: the pedestal's half width less the reach of the floor's force, in motion and at impacts."""


MAPPED: Final = {"peak": ("peak_theta_rad", 1.0, "rad", STILL_RAD), "slip": ("peak_slip_m", 1e3, "mm", 1e3 * STILL_M)}
"""What maps show: the value of a run, in how many of which unit, and up to where it is rounding."""


def design_figures(answers: Answers, say: Language = ENGLISH) -> list[tuple[str, Json]]:
    """For each model maps of the largest rotation where it stands, and where it slides of the pedestal's largest displacement.

    Places that would tip the pedestal are marked. Empty when what varies makes no map, or a place stands for several conditions.
    """
    shown = [name for name in MAPPED if name != "peak" or len(answers.cases) <= MOST_PLACES]
    found = [
        (say(f"chart.map_{name}", model=model), _value_map(name, model, answers, answers.single_plane, say))
        for name in shown for model in answers.models if answers.single_plane is not None
    ]  # fmt: skip
    return [(title, drawn) for title, drawn in found if drawn is not None]


def best_designs(answers: Answers) -> list[Finding]:
    """For each model that slides: of the designs in which the statue stands and nothing tips, the least slip, and which has it
    where one has. Shakings are no designs.
    """
    axes = answers.single_plane
    if axes is None or any(key.startswith("motion.") for key in axes):
        return []
    found = []
    for model in answers.models:
        runs = [(run, item) for item, run in answers.runs(model)]
        if not any(run.peak_slip_m > 0.0 for run, _ in runs):
            continue
        good = [(run, item) for run, item in runs if _stands(run) and not _tips(run)]
        if not good:
            found.append(info("no_design_stands", designs=len(runs), model=model))
            continue
        slip_m = min(float(run.peak_slip_m) for run, _ in good)
        best, *others = [item for run, item in good if run.peak_slip_m == slip_m]
        at = {} if others else {key: best.number(key) for key in axes}
        found.append(info("best_design", good=len(good), designs=len(runs), slip_m=slip_m, at=at, model=model))
    return found


def _stands(run: CaseRun) -> bool:
    """Whether the statue stands by what a run tells within its model's domain."""
    return told_family(run) == "stands"


def _tips(run: CaseRun) -> bool:
    margins = [run.validity.get(name) for name in TIPPING]
    return any(isinstance(margin, float) and margin < 0.0 for margin in margins)


def _value_map(name: str, model: str, answers: Answers, axes: tuple[str, str], say: Language) -> Json | None:
    """A map of one of `MAPPED`, of the slips with the places that tip; None where it is nought, or rounding, everywhere."""
    column, factor, unit, least = MAPPED[name]
    x, y = ((say.label(key), answers.numbers(key)) for key in axes)
    there = {tuple(item.number(key) for key in axes): run for item, run in answers.runs(model)}
    told = {place: factor * abs(getattr(run, column)) for place, run in there.items() if name == "slip" or _stands(run)}
    values = np.array([[told.get((at, up), np.nan) for at in x[1]] for up in y[1]])
    if not np.nanmax(values, initial=0.0) > least:
        return None
    crosses = marks("point", "tipping", shape="cross", angle=45, size=36, filled=True, color=INK)
    tipping = [columns("x y", [place for place, run in there.items() if _tips(run)])]
    return number_map(values, x, y, unit, say, over={"tipping": (tipping, crosses)} if name == "slip" else None)


# Studies along one axis: each model's outcome, largest rotation and slip against what varies.

MOST_GROUPS: Final = 6
"""More combinations of what else varies are no curves of one axis: the table shows them."""


def curve_figures(answers: Answers, say: Language = ENGLISH) -> list[tuple[str, Json]]:
    """For each axis of numbers, and each combination of the others, a chart of all models; none where there is a map."""
    numeric = [key for key in answers.axes if answers.plane is None and len(answers.numbers(key)) >= LEAST]
    groups = [(key, answers.apart([key], say)) for key in numeric]
    return [
        (say("text.by", name=say.label(key)) + where, _curves(members, key, say))
        for key, apart in groups if len(apart) <= MOST_GROUPS for where, members in apart
    ]  # fmt: skip


def _curves(answers: Answers, key: str, say: Language) -> Json:
    """Outcome and, where a statue that stands rocks or slides, largest rotation and slip; of one that falls these say nothing."""
    looks = model_looks(answers.models)
    along = {model: sorted(answers.runs(model), key=lambda each: each[0].number(key)) for model in answers.models}
    parts: list[Json] = [
        {
            "name": model, "x": [item.number(key) for item, _ in runs],
            "outcome": [told_symbol(run, say)[1] for _, run in runs],
            "theta": [abs(run.peak_theta_rad) if _stands(run) else None for _, run in runs],
            "slip": [1e3 * run.peak_slip_m if _stands(run) else None for _, run in runs],
        }
        for model, runs in along.items()
    ]  # fmt: skip
    outcomes = list(dict.fromkeys(words for part in parts for words in part["outcome"]))
    rows = [(names("outcome", outcomes[::-1], grid=True), 40 + 26 * len(outcomes))]
    for column, height, least in (("theta", 180, STILL_RAD), ("slip", 140, 1e3 * STILL_M)):
        if any((value or 0.0) > least for part in parts for value in part[column]):
            rows.append((axis(column, say(f"chart.{column}"), scale={"zero": True}), height))
    joined = all(len(set(part["x"])) == len(part["x"]) for part in parts)  # no line through draws of one place
    drawn = [(points("runs", looks, y, k == 0, joined), height) for k, (y, height) in enumerate(rows)]
    return rows_of(drawn, across("x", say.label(key)), {"runs": parts})


SLIP_COLOUR: Final = "#009E73"
SHOWN_RAD: Final = 0.50
"""The paper's figures show rotations up to this value."""
PANEL_CURVES: Final = (
    ("floor", "theta_rad", 1.0, FLOOR_COLOUR),
    ("pedestal", "theta_rad", 1.0, PEDESTAL_COLOUR),
    ("pedestal", "slip_m", 0.1, SLIP_COLOUR),
)
"""What a panel shows of a condition: setting, curve, factor, colour."""
LEAST_RUNS: Final = 10
"""Runs at one level below which a share says little."""

LEAST_DIRECTIONS: Final = 4
"""Directions in which the statue overturns below which a rose says little."""


def panels_figure(panels: Sequence[Panel], model: str | None = None, say: Language = ENGLISH) -> Json:
    """The paper's figures 7 to 9: amplitudes across, frequencies down, of one model (default: the first).

    It opens on the least restitution; the page's reader chooses another of both.
    """
    shown_as = [(*each, say(f"chart.panel_{each[0]}_{each[1]}")) for each in PANEL_CURVES]
    kinds_of = {name: Look(colour, "", 1.4) for *_, colour, name in shown_as}
    models = list(dict.fromkeys(model for panel in panels for model in panel.curves))
    parts: list[Json] = [
        {
            "name": name, "model": of, "r": panel.restitution, "place": place(panel, say),
            "t": np.asarray(curves[setting].t_s), "value": scale * np.asarray(getattr(curves[setting], column)),
        }
        for panel in panels for of, curves in panel.curves.items()
        for setting, column, scale, _, name in shown_as if setting in curves
    ]  # fmt: skip
    ends = {"domain": [0.0, max((float(part["t"][-1]) for part in parts), default=1.0)]}
    shown = {"domain": [-SHOWN_RAD, SHOWN_RAD]}
    order = [place(panel, say) for panel in sorted(panels, key=lambda each: (each.frequency_hz, each.amplitude_g))]
    params = [
        choice("model", say("chart.model"), models, model),
        choice("r", say("chart.restitution"), sorted({panel.restitution for panel in panels})),
    ]
    lines = marks(
        "line",
        "",
        {"x": across("t", say("chart.time"), ends), "y": axis("value", "", scale=shown, tickCount=5)}
        | named(kinds_of, chosen=False),
    )
    return {
        "datasets": {"panels": parts}, "params": [*ZOOMED, *params], "data": {"name": "panels"},
        "columns": len({panel.amplitude_g for panel in panels}),
        "facet": {"field": "place", "sort": list(dict.fromkeys(order)), "header": {"title": None}},
        "spec": lines | {"height": 120}, "spacing": {"row": 14, "column": BETWEEN},
    }  # fmt: skip


def place(panel: Panel, say: Language = ENGLISH) -> str:
    """What is said over a panel."""
    return say.row([f"{say.short(panel.amplitude_g)} g", f"{say.short(panel.frequency_hz)} Hz"])


def fragility_figure(answers: Answers, key: str, say: Language = ENGLISH) -> Json | None:
    """Share of overturned runs against an intensity, with 95 % intervals and the lognormal fit with its band.

    Everything else that varies is pooled; runs without an end are left out. None unless some model has at least three levels of
    ten runs each.
    """
    data: dict[str, list[Json]] = {"points": [], "fits": []}
    for model in answers.models:
        known = [(item, fallen) for item, run in answers.runs(model) if (fallen := falls(run)) is not None]
        levels = grouped((abs(item.number(key)), fallen) for item, fallen in known)
        if sum(len(fell) >= LEAST_RUNS for fell in levels.values()) >= 3:
            shares = [(x, share) for x, fell in sorted(levels.items()) if (share := wilson(sum(fell), len(fell)))]
            estimated = columns_of([share for _, share in shares])
            data["points"].append({"name": model, "x": [x for x, _ in shares], **estimated})
            data["fits"] += _fitted(model, levels)
    if not data["points"]:
        return None
    shown = {part["name"] for part in data["points"]}
    drawn = named({name: style for name, style in model_looks(answers.models).items() if name in shown})
    layers = chosen([band("fits", drawn, 0.12), marks("line", "fits", drawn), *estimates("points", drawn)])
    y = upwards("y", say("chart.share_overturns"), {"domain": [0.0, 1.0]})
    return figure(layers, 420, data, across("x", say.label(key)), y)


def _fitted(model: str, levels: Mapping[float, Sequence[bool]]) -> list[Json]:
    """The fitted curve of one model with its band; none where nothing can be fitted."""
    shaken = {x: fell for x, fell in levels.items() if x > 0.0}
    intensity = [x for x, fell in shaken.items() for _ in fell]
    curve_fit = fit_fragility(intensity, [fell for runs in shaken.values() for fell in runs])
    if curve_fit.median is None:
        return []
    xs = np.linspace(min(intensity), max(intensity), 120)
    low, high = curve_fit.band(xs)
    return [{"name": model, "x": xs, "y": curve_fit.probability(xs), "low": low, "high": high}]


def rose_picture(answers: Answers, say: Language = ENGLISH) -> Picture | None:
    """Least amplitude that overturns the statue, by direction of shaking; None without azimuths and amplitudes."""
    turn = next((key for key in answers.keys if key.endswith("azimuth_deg")), None)
    size = next((key for key in answers.keys if "amplitude" in key or key.endswith("scale")), None)
    if turn is None or size is None:
        return None
    drawn: list[RoseCurve] = []
    for model, style in model_looks(answers.models).items():
        by_angle = grouped((item.number(turn), (run, abs(item.number(size)))) for item, run in answers.runs(model))
        fell = {angle: [most for run, most in by_angle[angle] if run.outcome.overturned] for angle in sorted(by_angle)}
        if sum(map(bool, fell.values())) >= LEAST_DIRECTIONS:
            drawn.append(RoseCurve(model, {angle: min(sizes, default=None) for angle, sizes in fell.items()}, style))
    if not drawn:
        return None
    most = max(abs(item.number(size)) for item in answers.cases)
    return rose_of(drawn, most, " g" if size.endswith("_g") else "", say=say)
