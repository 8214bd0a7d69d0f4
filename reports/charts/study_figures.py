"""The pictures that a study's rows hold: the paper's panels, fragility, roses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

import numpy as np

from harness.comparison.statistics.distributions import wilson
from harness.comparison.statistics.fragility import fit
from harness.records.study import CaseRun, Panel
from reports.charts import Json
from reports.charts.figure import axis, band, curve, figure, intervals, stroke
from reports.charts.map_figures import LEAST, map_axes, numeric
from reports.charts.palette import INK, Look, model_looks
from reports.charts.samples import packed_array
from reports.charts.static_svg import picture_of
from reports.drawing.effects_figures import Curve, rose_of
from reports.drawing.shapes import Picture, titled
from reports.messages.numbers import heading, short
from reports.text.study_rows import FAILED, SYMBOLS, Condition, family, runs_of

# Maps of numbers: how far the statue rotates and its pedestal slides over what varies, and where the pedestal
# would tip.


MOST_PLACES: Final = 10_000
"""Larger maps show where the statue falls only: a number for every place would make the page large."""
TIPPING: Final = ("pedestal_tipping_margin_m", "pedestal_tipping_margin_at_impact_m")
"""The margins of the record: the pedestal's half width less the reach of the floor's force, in motion and at impacts."""


def design_figures(
    models: Sequence[str], conditions: Sequence[Condition], axes: tuple[str, str] | None
) -> list[tuple[str, Json]]:
    """For each model maps of the largest rotation where it stands, and where it slides of the pedestal's largest displacement.

    Places that would tip the pedestal are marked. Empty when what varies makes no map, or a place stands for several conditions.
    """
    if axes is None or len({tuple(item.varied[key] for key in axes) for item in conditions}) != len(conditions):
        return []
    figures = []
    for model in models if len(conditions) <= MOST_PLACES else ():
        peak = _value_map(
            model, conditions, axes, lambda run: abs(run.peak_theta_rad) if run.outcome == "stands" else np.nan, "rad"
        )
        if peak is not None:
            figures.append((f"{model}: largest rotation where the statue stands", {**peak, "data": peak["data"][:1]}))
    for model in models:
        slip = _value_map(model, conditions, axes, lambda run: 1000.0 * run.peak_slip_m, "mm")
        if slip is not None:
            figures.append((f"{model}: largest displacement of the pedestal; ✕ where the pedestal would tip", slip))
    return figures


def best_designs(models: Sequence[str], conditions: Sequence[Condition], axes: tuple[str, str] | None) -> list[str]:
    """For each model that slides one sentence: of the designs in which the statue stands and nothing tips, the least slip."""
    if axes is None or len({tuple(item.varied[key] for key in axes) for item in conditions}) != len(conditions):
        return []
    sentences = []
    for model in models:
        runs = [(run, item) for item, run in runs_of(conditions, model)]
        if not any(run.peak_slip_m > 0.0 for run, _ in runs):
            continue
        good = [(run, item) for run, item in runs if run.outcome == "stands" and not _tips(run)]
        if not good:
            sentences.append(
                f"In none of {len(runs)} designs does the statue stand on a pedestal that does not tip ({model})."
            )
            continue
        run, item = min(good, key=lambda pair: float(pair[0].peak_slip_m))
        where = " and ".join(f"{heading(key)} = {short(float(item.varied[key]))}" for key in axes)
        sentences.append(
            f"The statue stands and the pedestal does not tip in {len(good)} of {len(runs)} designs; of these the pedestal moves "
            f"least, {1000.0 * float(run.peak_slip_m):.0f} mm, at {where} ({model})."
        )
    return sentences


def _tips(run: CaseRun) -> bool:
    margins = [run.validity.get(name) for name in TIPPING]
    return any(isinstance(margin, float) and margin < 0.0 for margin in margins)


def _value_map(
    model: str, conditions: Sequence[Condition], axes: tuple[str, str], value_of: Callable[[CaseRun], float], unit: str
) -> Json | None:
    """A heatmap of one number of each run; None where it is nought everywhere."""
    xs, ys = (sorted({item.number(key) for item in conditions}) for key in axes)
    rows, columns = ({value: k for k, value in enumerate(side)} for side in (ys, xs))
    values = np.full((len(ys), len(xs)), np.nan)
    tips: list[tuple[float, float]] = []
    for item, run in runs_of(conditions, model):
        x, y = (item.number(key) for key in axes)
        values[rows[y], columns[x]] = value_of(run)
        tips += [(x, y)] if _tips(run) else []
    if not np.nanmax(values, initial=0.0) > 0.0:
        return None
    shown = [[None if np.isnan(value) else float(f"{value:.4g}") for value in line] for line in values]
    heat = {
        "type": "heatmap", "x": xs, "y": ys, "z": shown, "colorscale": "Cividis", "reversescale": True,
        "colorbar": {"title": {"text": unit}, "thickness": 12},
        "hovertemplate": f"{heading(axes[0])} %{{x:.4g}}<br>{heading(axes[1])} %{{y:.4g}}<br>%{{z}} {unit}<extra></extra>",
    }  # fmt: skip
    marks = {
        "type": "scatter", "mode": "markers", "x": [x for x, _ in tips], "y": [y for _, y in tips],
        "marker": {"symbol": "x-thin", "size": 7, "line": {"width": 1.2, "color": INK}}, "hoverinfo": "skip",
    }  # fmt: skip
    return figure(
        [heat, marks], 380, *({"title": {"text": heading(key)}} for key in axes), showlegend=False, margin_top=12
    )


# Studies along one axis: each model's outcome, largest rotation and slip against what varies.


MOST_GROUPS: Final = 6
"""More combinations of what else varies are no curves of one axis: the table shows them."""
ROWS: Final = (((0.70, 1.0), ""), ((0.36, 0.62), "rotation  [rad]"), ((0.0, 0.28), "slip  [mm]"))
"""Share of the chart's height and title of each row, from above."""


def curve_figures(
    models: Sequence[str], conditions: Sequence[Condition], keys: Sequence[str]
) -> list[tuple[str, Json]]:
    """For each axis of numbers, and each combination of the other `keys`, a chart of all models; none where there is a map."""
    if map_axes(conditions, keys) is not None:
        return []
    figures = []
    for key in keys:
        if len(numeric(conditions, key)) < LEAST:
            continue
        groups: dict[tuple[str, ...], list[Condition]] = {}
        for item in conditions:
            where = tuple(f"{heading(other)} {item.varied[other]}" for other in keys if other != key)
            groups.setdefault(where, []).append(item)
        if len(groups) <= MOST_GROUPS:
            figures += [
                (" · ".join([f"By {heading(key)}", *where]), _curves(models, members, key))
                for where, members in groups.items()
            ]
    return figures


def _curves(models: Sequence[str], members: Sequence[Condition], key: str) -> Json:
    looks, along = model_looks(models), sorted(members, key=lambda item: float(item.varied[key]))
    answers = {model: runs_of(along, model) for model in models}
    slips = any(run.peak_slip_m > 0.0 for runs in answers.values() for _, run in runs)
    rows = ROWS if slips else (((0.58, 1.0), ""), ((0.0, 0.46), ROWS[1][1]))
    data: list[Json] = []
    for model, runs in answers.items():
        shown = {"mode": "lines+markers", "name": model, "legendgroup": model, "marker": {"color": looks[model].colour}}
        x = [float(item.varied[key]) for item, _ in runs]
        for number, values in enumerate(_values([run for _, run in runs])[: len(rows)], start=1):
            place = {"yaxis": f"y{number if number > 1 else ''}", "showlegend": number == 1}
            data.append(curve(x, values, stroke(looks[model]), **shown, **place))
    layout = {
        f"yaxis{number if number > 1 else ''}": axis(
            title, domain=list(domain), automargin=True, type="category" if number == 1 else "linear", rangemode="tozero",
            nticks=4, exponentformat="none",
        )
        for number, (domain, title) in enumerate(rows, start=1)
    }  # fmt: skip
    return figure(data, 560, axis(heading(key), anchor=f"y{len(rows)}"), layout.pop("yaxis"), **layout)


def _values(runs: Sequence[CaseRun]) -> tuple[list[str], list[float | None], list[float | None]]:
    """Outcome in words, largest rotation in rad and slip in mm; where it does not stand these two say nothing."""
    stands = [run.outcome == "stands" for run in runs]
    return (
        [SYMBOLS.get(run.outcome, FAILED)[1] for run in runs],
        [abs(run.peak_theta_rad) if shown else None for run, shown in zip(runs, stands, strict=True)],
        [1e3 * run.peak_slip_m if shown else None for run, shown in zip(runs, stands, strict=True)],
    )


FLOOR_COLOUR: Final = "#0072B2"
PEDESTAL_COLOUR: Final = "#D55E00"
SLIP_COLOUR: Final = "#009E73"
SHOWN_RAD: Final = 0.50
"""The paper's figures show rotations up to this value."""
PANEL_CURVES: Final = (
    ("floor", "theta_rad", 1.0, FLOOR_COLOUR, "θ, on the floor (rad)"),
    ("pedestal", "theta_rad", 1.0, PEDESTAL_COLOUR, "θ, on the pedestal (rad)"),
    ("pedestal", "slip_m", 0.1, SLIP_COLOUR, "slip of the pedestal (m ÷ 10)"),
)
"""What a panel shows of a condition: setting, curve, factor, colour, words."""
PANEL_POINTS: Final = 150
"""Points of a curve in a small panel of a page's still."""
LEAST_RUNS: Final = 10
"""Runs at one level below which a share says little."""

LEAST_DIRECTIONS: Final = 4
"""Directions in which the statue overturns below which a rose says little."""


def panel_data(panels: Sequence[Panel]) -> Json:
    """The paper's figures 7 to 9: per restitution a grid of amplitude by frequency, for every model that has curves."""
    models: dict[str, None] = {}
    groups: dict[float, list[Json]] = {}
    for panel in panels:
        curves = {}
        for model, settings in panel.curves.items():
            models[model] = None
            curves[model] = {
                setting: {name: packed_array(values) for name, values in vars(curve).items()}
                for setting, curve in settings.items()
            }
        place = {"amplitude_g": panel.amplitude_g, "frequency_hz": panel.frequency_hz}
        groups.setdefault(float(panel.restitution), []).append({**place, "curves": curves})
    return {
        "models": list(models),
        "groups": [{"restitution": value, "panels": groups[value]} for value in sorted(groups)],
        "colours": {"floor": FLOOR_COLOUR, "pedestal": PEDESTAL_COLOUR, "slip": SLIP_COLOUR},
        "shown_rad": SHOWN_RAD,
    }


def panel_groups(panels: Sequence[Panel] | None) -> list[list[Panel]]:
    """The panels of each restitution."""
    groups: dict[float, list[Panel]] = {}
    for panel in panels or ():
        groups.setdefault(panel.restitution, []).append(panel)
    return list(groups.values())


def panels_picture(group: Sequence[Panel], model: str, width_px: float, points: int) -> Picture:
    """The arrangement of the paper's figures 7 to 9 for one model, named over it."""
    drawn = picture_of(panels_figure(group, model), width_px, points)
    return titled(drawn, f"{model}, r = {group[0].restitution:g}")


def panels_figure(group: Sequence[Panel], model: str) -> Json:
    """One model's panels of one restitution, arranged as in the paper's figures 7 to 9: amplitudes across, frequencies down."""
    amplitudes = sorted({panel.amplitude_g for panel in group})
    frequencies = sorted({panel.frequency_hz for panel in group})
    wide, high = 1.0 / len(amplitudes), 1.0 / len(frequencies)
    data: list[Json] = []
    notes: list[Json] = []
    layout: Json = {"height": 92 + 118 * len(frequencies), "showlegend": True}
    curves_shown = [curve for panel in group for curve in panel.curves.get(model, {}).values()]
    end_s = max((float(curve.t_s[-1]) for curve in curves_shown), default=1.0)
    for number, panel in enumerate(group):
        x, y = (f"{letter}{number + 1 if number else ''}" for letter in "xy")
        column, row = amplitudes.index(panel.amplitude_g), frequencies.index(panel.frequency_hz)
        left, top = column * wide, 1.0 - row * high
        lowest = row == len(frequencies) - 1
        layout[x.replace("x", "xaxis")] = {
            "domain": [left, left + 0.84 * wide], "anchor": y, "nticks": 5, "range": [0.0, end_s],
            "title": {"text": "time  [s]" if lowest else ""},
        }  # fmt: skip
        layout[y.replace("y", "yaxis")] = {
            "domain": [top - 0.62 * high, top], "anchor": x, "range": [-SHOWN_RAD, SHOWN_RAD], "nticks": 5,
            "title": {"text": "" if column else "θ  [rad]"},
        }  # fmt: skip
        curves = panel.curves.get(model, {})
        for setting, name, scale, colour, words in PANEL_CURVES:
            if setting in curves:
                data.append({
                    "type": "scatter", "mode": "lines", "x": curves[setting].t_s, "xaxis": x, "yaxis": y, "name": words,
                    "y": (scale * np.asarray(getattr(curves[setting], name))).tolist(), "line": {"color": colour, "width": 1.4},
                    "showlegend": words not in {trace["name"] for trace in data},
                })  # fmt: skip
        if curves:
            words = f"{panel.amplitude_g:g} g, {panel.frequency_hz:g} Hz"
            notes.append({
                "xref": f"{x} domain", "x": 0, "yref": f"{y} domain", "y": 1, "yanchor": "bottom", "xanchor": "left",
                "text": words,
            })  # fmt: skip
    return {"data": data, "layout": layout | {"annotations": notes}}


def fragility_figure(models: Sequence[str], conditions: Sequence[Condition], key: str) -> Json | None:
    """Share of overturned runs against an intensity, with 95 % intervals and the lognormal fit with its band.

    Everything else that varies is pooled. None unless some model has at least three levels of ten runs each.
    """
    data: list[Json] = []
    for model, style in model_looks(models).items():
        levels: dict[float, list[bool]] = {}
        for item, run in runs_of(conditions, model):
            if family(run.outcome) != "failed":
                levels.setdefault(float(item.varied[key]), []).append(run.outcome.overturned)
        if sum(len(fell) >= LEAST_RUNS for fell in levels.values()) >= 3:
            data += _fragility(model, style, levels)
    y = axis("share of runs that overturn", range=[-0.03, 1.03])
    return figure(data, 420, axis(heading(key)), y) if data else None


def _fragility(model: str, style: Look, levels: Mapping[float, Sequence[bool]]) -> list[Json]:
    """Points with Wilson's intervals, the fitted curve and its band, of one model."""
    shares = [(x, share) for x, fell in sorted(levels.items()) for share in [wilson(sum(fell), len(fell))] if share]
    intensity = [x for x, fell in levels.items() for _ in fell]
    curve_fit = fit(intensity, [fell for runs in levels.values() for fell in runs])
    xs = np.linspace(min(intensity), max(intensity), 120)
    low, high = curve_fit.band(xs)
    points = curve(
        [x for x, _ in shares], [share.value for _, share in shares], {}, mode="markers", name=model, legendgroup=model,
        marker={"color": style.colour}, error_y=intervals([share for _, share in shares], thickness=1),
    )  # fmt: skip
    if curve_fit.median is None:
        return [points]
    outline = packed_array(np.concatenate([xs, xs[::-1]])), packed_array(np.concatenate([high, low[::-1]]))
    fitted = curve(
        packed_array(xs), packed_array(curve_fit.probability(xs)), stroke(style), legendgroup=model, showlegend=False,
        hoverinfo="skip",
    )  # fmt: skip
    return [band(*outline, style.colour, 0.12, legendgroup=model), fitted, points]


def rose_picture(models: Sequence[str], conditions: Sequence[Condition]) -> Picture | None:
    """Least amplitude that overturns the statue, by direction of shaking; None without azimuths and amplitudes."""
    keys = list(conditions[0].varied) if conditions else []
    turn = next((key for key in keys if key.endswith("azimuth_deg")), None)
    size = next((key for key in keys if "amplitude" in key or key.endswith("scale")), None)
    if turn is None or size is None:
        return None
    drawn: list[Curve] = []
    for model, style in model_looks(models).items():
        least: dict[float, float | None] = {}
        for item, run in runs_of(conditions, model):
            angle, size_of = float(item.varied[turn]), float(item.varied[size])
            known = least.setdefault(angle, None)
            if run.outcome.overturned:
                least[angle] = size_of if known is None else min(known, size_of)
        if sum(value is not None for value in least.values()) >= LEAST_DIRECTIONS:
            drawn.append(Curve(model, sorted(least.items()), style.colour, style.dash, style.width + 0.4))
    if not drawn:
        return None
    most = max(float(item.varied[size]) for item in conditions)
    return rose_of(drawn, most, " g" if size.endswith("_g") else "")
