"""The page of a study: verdict, claims, outcome matrix, panels, maps, fragility, what was asked and what was not."""

from collections import Counter
from pathlib import Path
from typing import Final

from harness.model import grouped
from harness.records.run import in_domain
from harness.records.study import ClaimVerdict, StudyRecord, StudyRow
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Drawing,
    Facts,
    Group,
    Legend,
    Section,
    Table,
    Text,
    Verdict,
    code,
    command_line,
    grid,
    notes,
    repeat,
    section,
    verdict,
    words,
)
from reports.charts.map_figures import map_figures
from reports.charts.study_figures import (
    SHOWN_RAD,
    best_designs,
    curve_figures,
    design_figures,
    fragility_figure,
    panels_figure,
    rose_picture,
)
from reports.drawing.pictures import scene_svg
from reports.messages import Language
from reports.text.answers import Answers
from reports.text.giving_way import pedestal_effect
from reports.text.wording import (
    symbol,
    symbols,
    told_family,
    told_symbol,
    tone_of_study,
)

MOST_MATRIX_ROWS: Final = 300
"""Longer matrices are not read; the map shows them."""
JUDGED: Final = {"holds": "✓", "does not hold": "✕", "holds for some": "◐", "not tested": "–"}
"""The sign of each verdict on a claim."""


def blocks(_folder: Path, record: StudyRecord, say: Language) -> list[Block]:
    """The blocks of a study's page."""
    answers = Answers.of(record.rows, record.vary)
    effect, charts, rose = (
        pedestal_effect(record, answers, say),
        study_charts(record, answers, say),
        rose_picture(answers, say),
    )
    drawn: list[Chart | Drawing] = [*charts]
    drawn += [] if rose is None else [Drawing(rose.svg(say("text.study_rose")), [say("text.study_rose")], "chart-box")]
    reasons = [
        f"{count}: {say.word(reason)}" for reason, count in Counter(row.reason for row in record.rows).most_common()
    ]
    vary = [
        (say.value(key, "key"), say.row([say.value(value, "plain") for value in values]))
        for key, values in record.vary.items()
    ]
    scattered = {key: [item.number(key) for item in answers.cases] for key in answers.varying if key not in record.vary}
    vary += [
        (say.value(key, "key"), say.range([say.short(min(values)), say.short(max(values))]))
        for key, values in scattered.items()
    ]
    seconds = Facts([(name, say.value(value, "s")) for name, value in record.engine_seconds.items()])
    picture = Drawing(scene_svg(record.scene, say), [say("text.study_scene", title=record.scene.title)])
    shown = matrix(answers, say) if len(answers.cases) <= MOST_MATRIX_ROWS else None
    return [
        study_verdict(record, answers, say),
        *_claims(record, say),
        *(
            section(
                say, "panels", Chart("panels", say("text.panels_chart"), panels_figure(record.panels, say=say), 1060),
                words(say, "panels", shown=say.short(SHOWN_RAD)),
            )
            if record.panels else ()
        ),
        *section(
            say, "maps", grid(drawn)
        ),
        *(section(say, "pedestal", Text([say.say(effect[0])]), grid(effect[1])) if effect else ()),
        *(section(say, "matrix", Legend(symbols(say), say("text.matrix")), shown) if shown else ()),
        *section(say, "scene", Group("split", [picture, Facts(vary, "")])),
        *section(say, "asked", Text(reasons, "plan"), *notes(say, record.findings)),
        *repeat(
            say, record, command_line("study", record.file, *(record.asked or ())),
            more=[Group("", [seconds], say("text.engine_time"))],
        ),
    ]  # fmt: skip


def _claims(record: StudyRecord, say: Language) -> list[Section]:
    """The paper's claims down, the models across, each with its verdict and what it rests on."""
    judged = grouped((item.claim, _judged(item, say)) for item in record.claims or ())
    rows: list[list[str | Cell]] = [[f"({claim}) {say(f'claim.{claim}')}", *cells] for claim, cells in judged.items()]
    heads = [_head(name) for name in dict.fromkeys(item.model for item in record.claims or ())]
    claims = Table(say("table.claims"), [say("label.claim"), *heads], rows, "claims")
    return section(say, "claims", words(say, "claims"), claims) if rows else []


def _judged(item: ClaimVerdict, say: Language) -> Cell:
    text = item.evidence.text or say.say(item.evidence)
    return Cell(item.verdict, f"claim {item.verdict.replace(' ', '-')}", text, JUDGED[item.verdict], below=text)


def _head(model: str) -> Cell:
    engine, _, variant = model.partition(" (")
    return Cell(engine, below=variant[:-1])


def study_charts(record: StudyRecord, answers: Answers, say: Language) -> list[Chart]:
    """The charts that the rows hold, each with its name on the page and its words: maps, curves, fragility."""
    if record.panels:  # the paper's arrangement shows the same as histories
        return []
    found = {
        "map": map_figures(answers, say),
        "map-design": design_figures(answers, say),
        "curve": curve_figures(answers, say),
    }
    charts = [
        Chart(f"{name}-{k}", title, figure)
        for name, figures in found.items()
        for k, (title, figure) in enumerate(figures)
    ]
    scattered = len(answers.axes) < len(answers.varying)
    for key in answers.axes if scattered else ():
        if "amplitude" in key or key.endswith("scale"):
            figure = fragility_figure(answers, key, say)
            if figure is not None:
                charts.append(Chart(f"fragility-{key}", say("text.study_fragility", key=say.label(key)), figure))
    return charts


def study_verdict(record: StudyRecord, answers: Answers, say: Language) -> Verdict:
    """The record's answer; no green without a probability."""
    ends = [told_family(run) for model in answers.models for _, run in answers.runs(model)]
    tone = tone_of_study(ends) if code(record) == "overturning" else "differ"
    return verdict(record, tone, [say.say(each) for each in best_designs(answers)])


def matrix(answers: Answers, say: Language) -> Table:
    """What was varied, and every model's answer; `differs` where models of one variant do not agree (different falls do)."""
    rows: list[list[str | Cell]] = []
    models, keys = answers.models, answers.varying
    for item in answers.cases:
        runs = [(model, run) for model in models if (run := item.run(model)) is not None and in_domain(run)]
        by_variant = grouped((model.partition(" (")[2], run.outcome) for model, run in runs)
        ends = [{"" if each.overturned else symbol(each, say)[1] for each in group} for group in by_variant.values()]
        style = "differs" if any(len(each) > 1 for each in ends) else ""
        varied = [Cell(say.value(item.varied[key], "plain"), style) for key in keys]
        rows.append([*varied, *(_answer(item.answers.get(model), say) for model in models)])
    return Table(say("table.matrix"), [*map(say.label, keys), *map(_head, models)], rows, "matrix")


def _answer(row: StudyRow | None, say: Language) -> Cell:
    """One model's answer under one condition: a sign, in its colour, with its numbers under the pointer."""
    if row is None or row.run is None:
        sign, words = symbols(say)[-1]
        return Cell("", "o-none", words if row is None else say.word(str(row.reason)), sign, words)
    run = row.run
    sign, words = told_symbol(run, say)
    stood = told_family(run) == "stands" and run.peak_theta_rad is not None
    told = {
        "peak": abs(run.peak_theta_rad) if stood else None,
        "no_return": run.no_return_time_s,
        "error": run.numerical_uncertainty_rad,
    }
    known = [say(f"text.tip_{name}", value=say.digits(value, 4)) for name, value in told.items() if value is not None]
    return Cell("", f"o-{told_family(run)}", "; ".join([words, *known]), sign, words)
