"""The page of a validation: how often each model predicts what was measured, beside a bare threshold on PGV."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.records.scores import Verdict as Verdicts
from harness.validation.scenes import GRAVITY_M_S2
from reports.charts.palette import HAIRLINE, INK, faint, look
from reports.text.numbers import count_word, digits, listed, plain, short, unit
from reports.text.study_rows import FAILED, SYMBOLS
from reports.text.wording import Verdict

Json = dict[str, Any]

BASELINE: Final = "PGV threshold"
SCORES: Final = (
    ("accuracy", "right"),
    ("precision", "of those predicted to fall, fell"),
    ("recall", "of those that fell, predicted"),
    ("f1", "F1"),
    ("matthews", "Matthews' correlation"),
)
BASELINE_COLOUR: Final = "#8a6d00"
FELL: Final = "overturned"
DASHES: Final = ("solid", "dash", "dot", "dashdot", "longdash")


def context(folder: Path, record: dict[str, Any]) -> dict[str, Any]:
    """Everything that the validation template shows."""
    models: Mapping[str, Any] = record["models"]
    return {
        "title": f"Validation against {record['tests']} measured tests",
        "verdict": validation_verdict(record),
        "chips": [],
        "names": [*models, BASELINE],
        "score_rows": score_rows(record),
        "pairs": pair_sentences(record.get("pairs", [])),
        "unstated": sorted({name for pair in record.get("pairs", []) for name in pair["unstated"]}),
        "charts": charts(record),
        "fitted": {name: _fitted(item["fitted"]) for name, item in models.items()},
        "fit_share": record["fit_share"],
        "unfitted": record["unfitted"],
        "baseline": record["baseline"],
        "models": list(models),
        "rows": [_row(row, list(models)) for row in record["rows"]],
        "histories": [
            (name, item["test"], _history(item["scores"]))
            for name, scores in models.items()
            for item in scores["histories"]
        ],
        "settings": [(name, _settings(item)) for name, item in models.items()],
        "command": command(record),
        "runs": record["runs"],
        "versions": record["versions"],
        "machine": record["machine"],
        "seconds": unit(record["seconds"], "s"),
    }


def validation_verdict(record: Mapping[str, Any]) -> Verdict:
    """Which models are right most often, with the interval, and whether any beats the threshold."""
    known = {
        name: item["outcomes"]["accuracy"] for name, item in record["models"].items() if item["outcomes"]["accuracy"]
    }
    if not known:
        return Verdict("No model decided any test", "failed", [])
    bare = record["baseline"]["outcomes"]["accuracy"]
    best = _best(known)
    points = [f"{name}: {_share(item)} of the tests that it decides." for name, item in known.items()]
    for name, item in record["models"].items():
        outcomes = item["outcomes"]
        left = outcomes["undecided"] + outcomes["within_uncertainty"]
        if left or item["failed"]:
            points.append(
                f"{name} leaves {left} tests open ({outcomes['within_uncertainty']} within its numerical error); "
                f"{item['failed']} runs failed."
            )
    if bare is None:
        return Verdict(best, "agree", points)
    points.append(f"A bare threshold on PGV ({unit(record['baseline']['threshold_m_s'], 'm/s')}): {_share(bare)}.")
    better = [name for name, item in known.items() if item["low"] > bare["value"]]
    worse = [name for name, item in known.items() if item["high"] < bare["value"]]
    if better:
        share = "every model" if len(better) == len(known) else f"of {count_word(len(known))} models {listed(better)}"
        words = f"{share} {'beats' if len(better) in (1, len(known)) else 'beat'} a bare threshold on PGV beyond chance"
    elif worse:
        words = (
            f"no model beats a bare threshold on PGV, and {listed(worse)} {'is' if len(worse) == 1 else 'are'} worse"
        )
    else:
        words = "with these tests no model can be told from a bare threshold on PGV"
    return Verdict(f"{best}; {words} ({_share(bare)})", "agree" if better else "differ", points)


def _best(known: Mapping[str, Mapping[str, float]]) -> str:
    """Which models are right most often; a bare count, whose intervals may overlap."""
    most = max(item["value"] for item in known.values())
    best = [name for name, item in known.items() if item["value"] == most]
    if len(known) == 1:
        return f"{best[0]} is right in {_share(known[best[0]])} of the tests that it decides"
    if len(best) == 1:
        return f"{best[0]} is right most often, in {_share(known[best[0]])} of the tests that it decides"
    every = "All models are" if len(best) == len(known) else f"{listed(best)} are"
    return f"{every} right equally often, in {100 * most:.0f} % of the tests that they decide"


def _share(interval: Mapping[str, float]) -> str:
    return f"{100 * interval['value']:.0f} % ({100 * interval['low']:.0f}–{100 * interval['high']:.0f} %)"


def score_rows(record: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """The table of scores with their 95 % intervals, the baseline last."""
    models, bare = record["models"], record["baseline"]
    rows = []
    for key, words in SCORES:
        cells = [_cell(item["outcomes"].get(key), key) for item in models.values()]
        rows.append((words, [*cells, _cell(bare["outcomes"].get(key), key)]))
    for key, words in (("brier", "Brier's score of the probabilities"), ("brier_skill", "skill over the mean")):
        values = [item["probability"][key] for item in (*models.values(), bare)]
        if any(value is not None for value in values):
            rows.append((words, ["–" if value is None else digits(value) for value in values]))
    return rows


def pair_sentences(pairs: Sequence[Mapping[str, Any]]) -> list[tuple[str, str]]:
    """For each two models, how often they give the same outcome and the shares of the verdicts."""
    found = []
    for pair in pairs:
        same = pair["outcomes"]["side_accuracy"]
        text = f"the same outcome in {_share(same)} of {pair['cases']} tests; " if same else ""
        text += "; ".join(f"{each.value}: {100 * pair['verdicts'].get(each, 0.0):.0f} %" for each in Verdicts) + "."
        if pair["flips"]:
            text += f" In {pair['flips']} the outcome flips within the numerical error."
        found.append((f"{pair['a']} and {pair['b']}", text))
    return found


def _cell(interval: Mapping[str, float] | None, key: str) -> str:
    if interval is None:
        return "–"
    if key in ("f1", "matthews"):
        return f"{digits(interval['value'], 2)} ({digits(interval['low'], 2)} … {digits(interval['high'], 2)})"
    return _share(interval)


def _fitted(fitted: Mapping[str, Any]) -> str:
    if not fitted["tests"]:
        return "nothing was fitted"
    parts = [f"on {fitted['tests']} tests"]
    if fitted["friction"] is not None:
        parts.append(f"friction {short(fitted['friction'])}")
    parts += [f"{Path(body).name}: {short(float(angle))}°" for body, angle in fitted["azimuth_deg"].items()]
    return ", ".join(parts)


def _settings(item: Mapping[str, Any]) -> str:
    return (
        f"step {unit(item['dt_s'], 's')}" if item["dt_s"] is not None else f"accuracy {plain(item['accuracy_rad'])} rad"
    )


def command(record: Mapping[str, Any]) -> str:
    """The command that repeats the validation, with every option that is not at its default."""
    parts = [f"rockcheck validate {shlex.quote(record['experiments'])}", *(f"-e {name}" for name in record["models"])]
    parts += [f"--samples {record['samples']}"] if record.get("samples") else []
    parts += [f"--seed {record['seed']}"] if record.get("seed") else []
    name = record["fit_share"]["name"]
    return " ".join([*parts, f"--fit-share {name}"] if name != "fit" else parts)


def _history(scores: Mapping[str, Any] | None) -> str:
    """One computed history beside the measured one: numbers first, then why they differ."""
    if scores is None:
        return "no history was computed"
    parts = [
        f"up to {unit(scores['compared_until_s'], 's')}: {digits(scores['rms_theta_rad'])} rad apart (root mean square)"
    ]
    if scores["peak_ratio"] is not None:
        parts.append(f"largest rotation {digits(scores['peak_ratio'])} times the measured one")
    if scores["combined"] is not None:
        parts.append(f"magnitude error {digits(scores['magnitude'])}, phase error {digits(scores['phase'])}")
    return f"{', '.join(parts)}. {scores['verdict_sentence']}"


def _row(row: Mapping[str, Any], models: Sequence[str]) -> dict[str, Any]:
    observed = row["observed"]
    fell = observed.startswith(FELL)
    cells = []
    for name in models:
        sign, words = SYMBOLS.get(row["predicted"][name], FAILED)
        chance = row["probability"][name]
        cells.append(
            {
                "sign": sign,
                "words": words if chance is None else f"{words}; overturns in {100 * chance:.0f} % of the runs",
                "right": row["predicted"][name].startswith(FELL) == fell,
            }
        )
    seen = SYMBOLS.get(observed, ("✕", "overturned"))
    return {**row, "cells": cells, "seen": seen}


def charts(record: Mapping[str, Any]) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    found = [("accuracy", "Share of tests predicted right, with 95 % intervals", _accuracy(record))]
    found.append(("plane", "Every test, and where half of them fall", _plane(record)))
    fragility = _fragility(record)
    if fragility["data"]:
        found.append(("fragility", "Probability of overturning against PGV", fragility))
    return found


def _styles(record: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """Colour by engine; the settings of one engine differ by their dashes."""
    engines = [item["engine"] for item in record["models"].values()]
    found: dict[str, tuple[str, str]] = {}
    for index, (name, engine) in enumerate(zip(record["models"], engines, strict=True)):
        own, earlier = look(engine, engines), engines[:index].count(engine)
        others = [dash for dash in DASHES if dash != own.dash]
        found[name] = own.colour, own.dash if earlier == 0 else others[(earlier - 1) % len(others)]
    return found


def _accuracy(record: Mapping[str, Any]) -> Json:
    styles = _styles(record)
    rows = [(name, item["outcomes"]["accuracy"]) for name, item in record["models"].items()]
    rows = [*rows, (BASELINE, record["baseline"]["outcomes"]["accuracy"])]
    data = [
        {
            "type": "scatter", "mode": "markers", "x": [100 * item["value"]], "y": [name], "showlegend": False,
            "marker": {"size": 11, "color": styles.get(name, (BASELINE_COLOUR, ""))[0]},
            "error_x": {
                "type": "data", "symmetric": False, "array": [100 * (item["high"] - item["value"])],
                "arrayminus": [100 * (item["value"] - item["low"])], "thickness": 2,
            },
            "hovertemplate": f"{name} %{{x:.0f}} %<extra></extra>",
        }
        for name, item in rows if item is not None
    ]  # fmt: skip
    layout = {
        "height": 130 + 44 * len(rows), "xaxis": {"title": {"text": "right  [%]"}, "range": [0, 102], "gridcolor": HAIRLINE},
        "yaxis": {"autorange": "reversed", "automargin": True}, "margin_top": 14,
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _plane(record: Mapping[str, Any]) -> Json:
    data: list[Json] = []
    for fell, words, symbol, colour in ((False, "stood", "circle-open", "#0072B2"), (True, "fell", "x", "#D55E00")):
        rows = [row for row in record["rows"] if row["observed"].startswith(FELL) == fell and row["pga_g"] > 0.0]
        data.append(
            {
                "type": "scatter", "mode": "markers", "name": words, "text": [row["test"] for row in rows],
                "x": [row["pgv_m_s"] / (GRAVITY_M_S2 * row["pga_g"]) for row in rows], "y": [row["pga_g"] for row in rows],
                "marker": {"symbol": symbol, "size": 9, "color": colour},
                "hovertemplate": "%{text}: %{y:.3f} g<extra></extra>",
            }
        )  # fmt: skip
    curves = [("measured", INK, "solid", record["observed"]["contour"])]
    curves += [(name, *_styles(record)[name], item["contour"]) for name, item in record["models"].items()]
    for name, colour, dash, contour in curves:
        if contour is not None:
            line = contour["contour_50"]
            data.append(
                {
                    "type": "scatter", "mode": "lines", "name": f"half fall: {name}", "x": line["ratio_s"], "y": line["pga_g"],
                    "line": {"color": colour, "dash": dash, "width": 3 if name == "measured" else 1.6},
                }
            )  # fmt: skip
    layout = {
        "height": 440, "xaxis": {"title": {"text": "PGV / PGA  [s]"}, "gridcolor": HAIRLINE, "rangemode": "tozero"},
        "yaxis": {"title": {"text": "PGA  [g]"}, "gridcolor": HAIRLINE, "rangemode": "tozero"},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}


def _fragility(record: Mapping[str, Any]) -> Json:
    curves = [("measured", INK, "solid", record["observed"]["fragility_pgv"])]
    curves += [(name, *_styles(record)[name], item["fragility_pgv"]) for name, item in record["models"].items()]
    data: list[Json] = []
    for name, colour, dash, curve in curves:
        if curve is None or curve["median"] is None:
            continue
        x = curve["intensity"]
        if name == "measured":
            data.append(
                {
                    "type": "scatter", "x": [*x, *reversed(x)], "y": [*curve["high"], *reversed(curve["low"])],
                    "fill": "toself", "fillcolor": faint(colour, 0.1), "line": {"width": 0}, "hoverinfo": "skip",
                    "showlegend": False,
                }
            )  # fmt: skip
        style = {"color": colour, "dash": dash, "width": 3 if name == "measured" else 1.6}
        data.append(
            {"type": "scatter", "mode": "lines", "name": name, "x": x, "y": curve["probability"], "line": style}
        )
    layout = {
        "height": 400, "xaxis": {"title": {"text": "PGV  [m/s]"}, "type": "log", "gridcolor": HAIRLINE},
        "yaxis": {"title": {"text": "probability of overturning"}, "range": [-0.02, 1.02], "gridcolor": HAIRLINE},
        "legend": {"orientation": "h", "y": 1.0, "yanchor": "bottom"},
    }  # fmt: skip
    return {"data": data, "layout": layout}
