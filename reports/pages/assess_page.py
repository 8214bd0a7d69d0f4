"""The page of an assessment: how probable the fall is, by each model; what it depends on; how strong a shaking is borne."""

from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.accuracy.horizon import MODEL
from harness.input.tables import assumption
from harness.model import Uncertain
from harness.questions.assess.assessment import CLEAR, clearance
from harness.questions.assess.probability import LEAST_INDEXED
from harness.records.assess import Assessment, AssessRecord, ClearanceByModel, FragilityRecord, OptionAnswer
from reports.blocks import (
    Block,
    Chart,
    Details,
    Drawing,
    Facts,
    Section,
    Table,
    Text,
    Verdict,
    command_line,
    notes,
    repeat,
    section,
    table,
    verdict,
    words,
)
from reports.charts.figure import INK, MUTED, Json, Look, across, discs, figure, level, log, marks, span, upwards
from reports.drawing.pictures import plan_sketch, probable_plan
from reports.messages import ENGLISH, Language, probability_text
from reports.pages.run_page import as_run
from reports.source import tone_of_answers


def assess_page(_folder: Path, record: AssessRecord, say: Language) -> list[Block]:
    """The blocks of an assessment's page."""
    fragility = record.fragility
    return [
        assess_verdict(record),
        *section(say, "notes", *notes(say, record.findings)),
        *section(
            say, "models", models_table(record, say), words(say, "assess")
        ),
        *_options(record, say),
        *_clearance(record, say),
        *(
            section(
                say, "fragility", Chart("fragility", say("text.fragility_chart"), fragility_by_factor(fragility, say), 1060),
                words(say, "fragility", model=fragility.model, draws=fragility.draws),
            )
            if fragility else ()
        ),
        *_inputs(record, say),
        *repeat(say, record, *_again(record, say), more=[words(say, "seed", seed=record.seed)]),
    ]  # fmt: skip


def models_table(record: AssessRecord, say: Language) -> Table | None:
    """How probable a fall is by each model, or why it says nothing; the terminal shows the same."""
    rows = [
        {"model": name, "probability": _probability(item, say), "interval": _between(say, item),
         "draws": item.draws, "runs": item.engine_runs, "undecided": say.value(item.undecided, "share")}
        if isinstance(item, Assessment) else
        {"model": name, "probability": say("text.not_assessed"), "interval": item.message if item and not item.runs else "",
         **dict.fromkeys(("draws", "runs", "undecided"), "")}
        for name, item in record.assessment.items()
    ]  # fmt: skip
    return table(say, "assess", "model probability interval draws runs undecided", rows)


def assess_verdict(record: AssessRecord) -> Verdict:
    """The record's answer, in the colour of the most probable fall."""
    return verdict(record, tone_of_answers(record.answers) if record.answers else "failed")


def _probability(item: Assessment | OptionAnswer, say: Language) -> str:
    """How probable the fall is; of one that may as well be improbable no number."""
    return say.value(item.probability_overturned, "share") if item.tells else "–"


def _between(say: Language, item: Assessment | OptionAnswer) -> str:
    return say.range([say.value(item.low, "share"), say.value(item.high, "share")]).replace(" ", "\u00a0")


def _changed(item: OptionAnswer, say: Language) -> str:
    """What an option changes: the user's own in the keys of its file."""
    if "set" in item.values:
        return str(item.values["set"])
    kind = "friction" if "static" in item.values else item.name
    numbers = {key: say.short(value) for key, value in item.values.items() if not isinstance(value, str)}
    pair = item.values.get("pair")
    published = str(item.values.get("published", "")) if pair is None else say(f"published.{pair}")
    return say(f"option.{kind}", **numbers, published=published)


def _options(record: AssessRecord, say: Language) -> list[Section]:
    """Options with common random numbers: what each does to the probability and to the pedestal's slip."""
    options = record.options
    if options is None:
        return []

    def slip(value_m: float | None, item: OptionAnswer) -> str:
        if value_m is None:
            return say("text.not_followed")
        return say.value(value_m, "m") if item.slip_high_m else say("text.none")

    rows = [
        {
            "option": say.word(item.name),
            "probability": _probability(item, say)
            + (f" ({say('text.no_end', share=say.value(item.undecided, 'share'))})" if item.undecided else ""),
            "shown": "" if item.difference is None
            else say("text.helps" if item.helps else "text.harms" if item.harms else "text.not_shown"),
            "interval": _between(say, item),
            "change_points": "" if item.difference is None
            else "{} ({})".format(
                say.value(item.difference.value, "points"),
                say.range([say.value(each, "points") for each in (item.difference.low, item.difference.high)]),
            ).replace(" ", "\u00a0"),
            "slip_median": slip(item.slip_median_m, item),
            "slip_high": slip(item.slip_high_m, item),
        }
        for item in options.options
    ]  # fmt: skip
    fewer = sorted({item.draws for item in options.options} - {options.draws})
    some = say("text.fewer_draws", draws=", ".join(map(str, fewer))) if fewer else ""
    what = [
        (say.word(item.name), f"{_changed(item, say)}{say('text.source', source=item.source) if item.source else ''}")
        for item in options.options[1:]
    ]
    left = [
        say("text.option_left_out", name=say.word(name), reason=say.word(reason))
        for name, reason in options.left_out.items()
    ]
    columns = "option probability shown interval change_points slip_median slip_high"
    return section(
        say, "options", table(say, "options", columns, rows, "options", model=options.model),
        words(say, "options", draws=options.draws, some=some, level=say.value(options.difference_level, "share")),
        words(say, "planar" if options.model == MODEL else "in_space"),
        Details(say("text.each_option"), [Facts(what), Text(left, "variant")], fold=True),
    )  # fmt: skip


def _clearance(record: AssessRecord, say: Language) -> list[Section]:
    """The room that the statue needs, drawn and by direction."""
    room, told = record.clearance, record.whole_clearance
    plan = None if told is None else probable_plan(told, CLEAR)
    drawn = None
    if told is not None and plan is not None:
        needed = replace(plan, room_m={side: each for side, each in plan.room_m.items() if each})
        sketch = plan_sketch(record.scene, needed, say).svg(say.say(clearance(told)), "plain")
        drawn = Drawing(sketch, [say("text.plan")], "chart-box")
    tables = [
        Details(say("text.by", name=name), [_by_direction(name, item, say)], fold=True)
        for name, item in (room.answered.items() if room else ())
    ]
    return section(say, "clearance", drawn, *tables, words(say, "clearance")) if room else []


def _by_direction(name: str, item: ClearanceByModel, say: Language) -> Table:
    """A model's table by direction: quantiles of the outline's way, and at one share of top and pedestal."""
    at = list(item.share).index(CLEAR)
    heads = [say("text.of_100", what=say("label.outline"), share=probability_text(share)) for share in item.share]
    heads += [
        say("text.of_100", what=say(f"label.{part}"), share=probability_text(CLEAR)) for part in ("top", "pedestal")
    ]
    columns = zip(*item.outline_m, item.top_m[at], item.pedestal_m[at], strict=True)
    rows = [
        [_towards(angle, say), *(say.length(round(value, 4)) for value in row)]
        for angle, row in zip(item.direction_deg, columns, strict=True)
    ]
    return Table(say("table.clearance", name=name), ["", *heads], rows)


def _towards(angle_deg: float, say: Language) -> str:
    side = {0.0: "right", 90.0: "back", 180.0: "left", 270.0: "front"}.get(angle_deg)
    return f"{say.short(angle_deg)}°" + (f", {say(f'side.{side}')}" if side else "")


def _inputs(record: AssessRecord, say: Language) -> list[Section]:
    """What is uncertain, whence its width comes, and how much of the answer hangs on it."""
    rows = [
        {"input": item.key, "value": float(item.value), "distribution": say(f"text.{item.kind}"),
         "width": _width(item, say), "source": _source(item, say, assumed=record.assumed)}
        for item in record.uncertainty
    ]  # fmt: skip
    indices = [
        {"input": key, "first": item.first, "total": say("text.not_computed") if item.total is None else item.total,
         "half_width": f"± {say.digits(item.half_width, 2)}"}
        for key, item in (record.indices or {}).items()
    ]  # fmt: skip
    totals = any(item.total is not None for item in (record.indices or {}).values())
    told = (
        words(say, "indices" if totals else "indices_few") if indices else words(say, "no_indices", least=LEAST_INDEXED)
    )
    return section(
        say, "inputs", words(say, "assumed") if record.assumed else None,
        table(say, "inputs", "input value distribution width source", rows),
        table(say, "indices", "input first total half_width", indices), told,
    )  # fmt: skip


def _width(item: Uncertain, say: Language) -> str:
    width = say(f"text.width_{item.kind}", width=say.digits(item.width))
    if item.correlated_with is None:
        return width
    return f"{width} {say('text.correlated', rho=say.short(item.rho), other=item.correlated_with)}"


def _source(item: Uncertain, say: Language, *, assumed: bool) -> str:
    """Where a width comes from: the scene's own, or what is assumed of such a key, with its source."""
    given = assumption(item.key)
    if given is None or (given.kind, given.width) != (item.kind, item.width):
        return say("text.own_width")
    source = say(f"assumed.{given.name}")
    return source if assumed else say("text.as_assumed", source=source)


def _again(record: AssessRecord, say: Language) -> list[str]:
    """The command of the assessment, and its scene as it was run."""
    file = record.scene.file or "SCENE"
    return [
        command_line("assess", file, *(record.asked or ()), e=[*record.assessment], seed=record.seed),
        *as_run(record.scene, say),
    ]


TICKS: Final = [0.25, 0.5, 1.0, 2.0, 4.0]
"""Factors written on the axis."""


def fragility_by_factor(fragility: FragilityRecord, say: Language = ENGLISH) -> Json:
    """The probability of overturning by a factor on the shaking, with its band."""
    chance = fragility.probability_overturned
    tips = [
        f"× {say.digits(factor)}: {say.percent(value)}" for factor, value in zip(fragility.factor, chance, strict=True)
    ]
    data = {"curve": [{"name": fragility.model, "x": fragility.factor, "y": chance, "tip": tips}]}
    layers = [marks("line", "curve", strokeWidth=2, color=INK), discs("curve", {}, color=INK)]
    if fragility.low:
        data["band"] = [{"x": fragility.factor, "low": fragility.low, "high": fragility.high}]
        layers.insert(0, marks("area", "band", span("low", "high"), color=INK, opacity=0.1))
    layers += level(1.0, say("chart.today"), "x", Look(MUTED, "4 3", 1.0))
    x = across("x", say("chart.factor"), log(), values=TICKS)
    return figure(
        layers, 380, data, x, upwards("y", say("chart.overturning_probability"), {"domain": [0.0, 1.0]}, format=".0%")
    )
