"""The pages of validations: how often each model predicts what was measured, beside a bare threshold on PGV; measured sets."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.comparison.statistics import FELL
from harness.model import info
from harness.questions.validate.scenes import GRAVITY_M_S2
from harness.records.scores import Scores
from harness.records.scores import Verdict as Verdicts
from harness.records.validation import (
    BaselineRecord,
    Curves,
    MeasuredRecord,
    MeasuredTable,
    ModelRecord,
    PairScores,
    TestRow,
    ValidationRecord,
)
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Facts,
    Group,
    Table,
    Text,
    command_line,
    grid,
    notes,
    repeat,
    section,
    table,
    verdict,
)
from reports.charts.figure import (
    HAIRLINE,
    INK,
    Json,
    Look,
    across,
    band,
    columns,
    columns_of,
    estimates,
    figure,
    log,
    look,
    marks,
    named,
    names,
    stroke,
    upwards,
)
from reports.messages import ENGLISH, Language
from reports.source import SIGNS, symbol

RATES: Final = ("accuracy", "precision", "recall", "f1", "matthews")
PLAIN: Final = ("f1", "matthews", "area")
"""Scores that are no share."""


def validation_page(_folder: Path, record: ValidationRecord, say: Language) -> list[Block]:
    """The blocks of a validation's page."""
    models = record.models
    unstated = sorted({name for pair in record.pairs for name in pair.unstated})
    pairs = [Facts([(say("text.and", a=each.a, b=each.b), _both(each, say)) for each in record.pairs], "sentences")]
    beside = Text([say("text.pairs"), *([say("text.unstated", names=say.listed(unstated))] if unstated else [])])
    fitted = Facts(
        [
            (name, say.say(info("fitted", any=bool(item.fitted.tests), **vars(item.fitted))))
            for name, item in models.items()
        ],
        "",
    )
    chosen = [
        {
            **vars(each),
            "model": name,
            "input": say.word(each.input).replace("_", " "),
            "weight": say.percent(each.weight),
        }
        for name, item in models.items()
        for each in item.fitted.inputs
    ]
    inputs = table(say, "fitted", "model body day input value weight", chosen, count=4)
    told = [
        (f"{name}, {item.test}", _history(item.scores, say))
        for name, scores in models.items()
        for item in scores.histories
    ]
    settings = [
        (
            name,
            say("text.accuracy", rad=say.plain(item.accuracy_rad))
            if item.dt_s is None
            else say("text.step", step=say.value(item.dt_s, "s")),
        )
        for name, item in models.items()
    ]
    share = record.fit_share.name
    again = command_line(
        "validate", record.experiments, e=[*models], samples=record.samples, seed=record.seed,
        fit_share="" if share == "fit" else share,
    )  # fmt: skip
    return [
        verdict(record),
        *section(say, "notes", *notes(say, record.findings)),
        *section(
            say, "scores", _scores(record, say),
            Group("", [*pairs, beside], say("text.beside_each_other")) if record.pairs else None,
            Group("", [fitted, *([inputs] if inputs else [])], say("text.fitted")),
        ),
        *section(say, "charts", grid(Chart(*each) for each in charts(record, say))),
        *section(
            say, "tests", _tests(record, say),
            Group("", [Facts(told, "sentences")], say("text.measured_histories")) if told else None,
        ),
        *repeat(say, record, again, more=[Group("", [Facts(settings)], say("text.settings"))]),
    ]  # fmt: skip


def _scores(record: ValidationRecord, say: Language) -> Table:
    """Each model's scores with their intervals, and the threshold's."""
    models, baseline = [*record.models.values()], record.baseline
    chances = [*(item.probability for item in models), baseline.probability]
    known = [*(item.outcomes for item in models), baseline.outcomes]
    drawn = [*(item.by_probability for item in models), None]

    def rate(item: Any, key: str) -> str:
        value = item and getattr(item, key)
        if not value:
            return "–"
        ends = [say.digits(each, 2) for each in (value.low, value.high)]
        return (
            f"{say.digits(value.value, 2)} ({' … '.join(ends)})"
            if key in PLAIN
            else say.value([value.value, value.low, value.high], "rate")
        )

    by_draws = {key: say("text.by_probability", score=say.label(key)) for key in RATES if record.samples}
    numbers = {key: [getattr(item, key) for item in chances] for key in ("brier", "brier_skill")}
    rows = [
        *([say.label(key), *(rate(item, key) for item in known)] for key in RATES),
        *([words, *(rate(item, key) for item in drawn)] for key, words in by_draws.items()),
        *([say.label(key), *(rate(item, key) for item in chances)] for key in ("area",) if record.samples),
        *([say.label(key), *map(say.plain, each)] for key, each in numbers.items() if any(x is not None for x in each)),
    ]
    fitted_on = say.word("named_share" if 0 < record.fit_share.tests < record.tests else "other_tests")
    return Table(say("table.validation", fitted_on=fitted_on), ["", *record.models, say("word.pgv_threshold")], rows)


def _both(pair: PairScores, say: Language) -> str:
    """In how many tests two models say the same, and how their largest rotations compare."""
    same = pair.outcomes.side_accuracy
    shares = {say(f"pair.{each.name.lower()}"): say.value(pair.verdicts.get(each, 0.0), "share") for each in Verdicts}
    rate = [same.value, same.low, same.high] if same else None
    return say.say(info("pair_in_tests", same=rate, cases=pair.cases, verdicts=shares, flips=pair.flips))


def _history(own: Scores | None, say: Language) -> str:
    """How far a computed history is from the measured one."""
    if own is None:
        return say("text.no_history")
    errors = {} if own.combined is None else {"magnitude": own.magnitude, "phase": own.phase}
    values = {"until_s": own.compared_until_s, "rms_rad": own.rms_theta_rad, "ratio": own.peak_ratio, **errors}
    return f"{say.say(info('history_apart', **values))} {own.verdict_sentence}"


def _tests(record: ValidationRecord, say: Language) -> Table:
    """Every test: what was measured, and what each model predicts of it."""
    keys = ("test", "body", "share", "pga_g", "pgv_m_s", "measured")
    rows: list[list[str | Cell]] = []
    for row in record.rows:
        fell, seen = row.observed.startswith(FELL), say("ends.overturns")
        sign, seen = symbol(row.observed, say) if row.observed in SIGNS else ("✕", seen)
        first = [row.test, row.body, row.share, say.digits(row.pga_g), say.digits(row.pgv_m_s)]
        cells = [_predicted(row, name, say, fell=fell) for name in record.models]
        rows.append([*first, Cell("", "", seen, sign, seen), *cells])
    return Table(say("table.tests"), [*map(say.label, keys), *record.models], rows, "matrix")


def _predicted(row: TestRow, name: str, say: Language, *, fell: bool) -> Cell:
    end, chance = row.predicted[name], row.probability[name]
    sign, said = symbol(end, say)
    said += "" if chance is None else say("text.overturns_in", share=f"{100 * chance:.0f}")
    right = end.startswith(FELL) == fell
    style, note = ("o-stands", "") if right else ("o-overturns", say("text.wrong"))
    return Cell(note, style, said, sign, said)


BASELINE_LOOK: Final = Look("#8a6d00", "2 3")


DASHES: Final = ("", "6 4", "1.5 3", "6 3 1.5 3", "10 4")


Seen = Sequence[tuple[str, Look, Curves]]
"""What was measured and each model by name: how its line is drawn, and its curves."""


Scored = Sequence[tuple[str, Look, ModelRecord | BaselineRecord]]
"""Each model and the threshold of intensity."""


def charts(record: ValidationRecord, say: Language = ENGLISH) -> list[tuple[str, str, Json]]:
    """Accuracy by model, tests in PGA against PGV/PGA with contours, fragility curves, accuracy by intensity."""
    looks = styles({name: item.engine for name, item in record.models.items()})
    models = [(name, looks[name], item) for name, item in record.models.items()]
    seen: Seen = [(say("chart.measured"), Look(INK, "", 3.0), record.observed), *models]
    scored: Scored = [*models, (say("word.pgv_threshold"), BASELINE_LOOK, record.baseline)]
    drawn = {
        "accuracy": _accuracy(scored, say), "plane": _plane(record.rows, seen, say), "fragility": _fragility(seen, say),
        "reliability": _reliability(scored, say) if record.samples else None,
    }  # fmt: skip
    return [(name, say(f"chart.validation_{name}"), each) for name, each in drawn.items() if each is not None]


def styles(engine_of: Mapping[str, str]) -> dict[str, Look]:
    """Colour by engine; the settings of one engine differ by their dashes."""
    engines = list(engine_of.values())
    looks: dict[str, Look] = {}
    for index, (name, engine) in enumerate(engine_of.items()):
        own, earlier = look(engine, engines), engines[:index].count(engine)
        others = [dash for dash in DASHES if dash != own.dash]
        looks[name] = Look(own.colour, own.dash if earlier == 0 else others[(earlier - 1) % len(others)])
    return looks


def _accuracy(scored: Scored, say: Language) -> Json:
    """The share of tests of which each model said the end, beside what the threshold of intensity says."""
    rows = {name: each.outcomes.accuracy for name, _, each in scored if each.outcomes.accuracy is not None}
    parts = [
        {"name": name, "y": [name], "tip": [f"{name} {100 * item.value:.0f} %"], **columns_of([item], 100.0, "x")}
        for name, item in rows.items()
    ]
    colour = named({name: look for name, look, _ in scored}, legend=False)["color"]
    layers = estimates("shares", {"color": colour}, "x")
    x = across("x", say("chart.right"), {"domain": [0, 100]})
    return figure(layers, 40 + 40 * len(rows), {"shares": parts}, x, names("y", list(rows), grid=False))


def _plane(tests: Sequence[TestRow], seen: Seen, say: Language) -> Json:
    """Every test by its intensities, with each model's contour of even chances."""
    stood, fallen = say("chart.stood"), say("chart.fell")
    parts = [
        {"kind": words, **columns("x y tip", [
            (row.pgv_m_s / (GRAVITY_M_S2 * row.pga_g), row.pga_g, f"{row.test}: {say.digits(row.pga_g)} g, {words}")
            for row in tests if row.pga_g > 0.0 and row.observed.startswith(FELL) == fell
        ])}
        for fell, words in ((False, stood), (True, fallen))
    ]  # fmt: skip
    kind: Json = {"field": "kind", "type": "nominal"}
    sign = {
        "shape": kind | {"scale": {"domain": [stood, fallen], "range": ["circle", "M-1-1L1 1M-1 1L1-1"]}},
        "stroke": kind | {"scale": {"domain": [stood, fallen], "range": ["#0072B2", "#D55E00"]}},
    }
    layers = [marks("point", "tests", sign, size=50, strokeWidth=1.6, filled=False)]
    contours = [
        (say("chart.half_fall", name=name), style, item.contour.contour_50)
        for name, style, item in seen if item.contour is not None
    ]  # fmt: skip
    lines = [{"name": words, "x": each.ratio_s, "y": each.pga_g} for words, _, each in contours]
    if contours:
        layers.append(marks("line", "contours", named({words: style for words, style, _ in contours}, chosen=False)))
    x, y = across("x", "PGV / PGA  [s]", {"zero": True}), upwards("y", "PGA  [g]", {"zero": True})
    return figure(layers, 420, {"tests": parts, "contours": lines}, x, y)


def _fragility(seen: Seen, say: Language) -> Json | None:
    """The fitted curves, that of the measured tests with its band."""
    fitted = [
        (name, style, item.fragility_pgv)
        for name, style, item in seen
        if item.fragility_pgv is not None and item.fragility_pgv.median is not None
    ]
    if not fitted:
        return None
    drawn = named({name: style for name, style, _ in fitted}, chosen=False)
    curves = [{"name": name, "x": each.intensity, "y": each.probability} for name, _, each in fitted]
    around = [
        {"name": name, "x": each.intensity, "low": each.low, "high": each.high}
        for name, _, each in fitted
        if name == seen[0][0]
    ]
    layers = [band("around", drawn, 0.1), marks("line", "curves", drawn)]
    y = upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]})
    return figure(layers, 380, {"curves": curves, "around": around}, across("x", "PGV  [m/s]", log(), tickCount=6), y)


def _reliability(scored: Scored, say: Language) -> Json | None:
    """The share that fell over the mean probability of each bin; true ones lie on the diagonal."""
    bins = {name: each.probability.reliability for name, _, each in scored if each.probability.reliability}
    if not bins:
        return None
    drawn = named({name: look for name, look, _ in scored if name in bins}, chosen=False)
    parts = [
        {
            "name": name, "x": [item.mean for item in mine], **columns_of([item.fell for item in mine]),
            "tip": [
                say("chart.bin", name=name, cases=item.cases, said=say.digits(item.mean, 2), fell=say.digits(item.fell.value, 2))
                for item in mine
            ],
        }
        for name, mine in bins.items()
    ]  # fmt: skip
    layers = [
        marks("line", "true", **stroke(Look(HAIRLINE, "", 2.0))),
        marks("line", "bins", drawn),
        *estimates("bins", drawn),
    ]
    shown = {"domain": [0.0, 1.0]}
    x, y = across("x", say("chart.overturning_probability"), shown), upwards("y", say("chart.share_fell"), shown)
    return figure(layers, 400, {"bins": parts, "true": [{"x": [0.0, 1.0], "y": [0.0, 1.0]}]}, x, y)


# A measured set, which is told by tables.


def measured_page(_folder: Path, record: MeasuredRecord, say: Language) -> list[Block]:
    """The blocks of the page."""
    return [
        verdict(record, more=[each.text for each in record.findings]),
        *section(say, "tables", *(measured_table(each, say) for each in record.tables)),
        *repeat(say, record, command(record)),
    ]


def measured_table(table: MeasuredTable, say: Language) -> Table:
    """A table with its columns' names in words and its numbers to three digits."""
    rows = [[say.plain(value, 3) for value in row] for row in table.rows]
    # Cells of words stand as those of claims do, from the left.
    style = "claims" if all(isinstance(value, str) for row in table.rows for value in row) else ""
    return Table(say(f"measured.{table.name}"), [*map(say.label, table.columns)], rows, style)


def command(record: MeasuredRecord) -> str:
    """The command that repeats it."""
    if record.about == "checked":
        return "python -m tests.measures.checked"
    rows = record.tables[0].rows if record.body else ()
    models = dict.fromkeys(str(row[0]) for row in rows if row[-1] is not None and "published" not in row)
    samples = record.samples if record.body else None
    return command_line("validate", record.source, body=record.body, e=[*models], samples=samples, seed=record.seed)
