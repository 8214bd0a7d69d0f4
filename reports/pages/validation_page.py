"""The page of a validation: how often each model predicts what was measured, beside a bare threshold on PGV."""

from pathlib import Path
from typing import Any, Final

from harness.comparison.statistics import FELL
from harness.model import info
from harness.records.scores import Scores
from harness.records.scores import Verdict as Verdicts
from harness.records.validation import PairScores, TestRow, ValidationRecord
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
from reports.charts.curve_figures import charts
from reports.messages import Language
from reports.text.wording import SIGNS, symbol

RATES: Final = ("accuracy", "precision", "recall", "f1", "matthews")
PLAIN: Final = ("f1", "matthews", "area")
"""Scores that are no share."""


def blocks(_folder: Path, record: ValidationRecord, say: Language) -> list[Block]:
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
