"""The page of an effects study: what the third dimension changes, by direction, against what a survey does not know."""

from collections.abc import Sequence
from pathlib import Path

from harness.records.effects3d import BASELINE, Effect, EffectsRecord
from reports.blocks import (
    Block,
    Chart,
    Details,
    Drawing,
    Group,
    Legend,
    Table,
    command_line,
    notes,
    repeat,
    section,
    table,
    verdict,
    words,
)
from reports.charts.figure import look
from reports.drawing.effects_figures import changes, directions, rose
from reports.drawing.pictures import scene_svg
from reports.messages import Language
from reports.pages.run_page import chip, replay
from reports.source import run_source


def blocks(folder: Path, record: EffectsRecord, say: Language) -> list[Block]:
    """The blocks of an effects study's page."""
    engines, chosen = record.engines, record.replay
    source = run_source(folder / chosen.folder) if chosen else None
    scan = source and directions(record, source, say)
    asked = list(dict.fromkeys(item.engine for item in record.effects))
    colours = [(look(name, engines).colour, name) for name in engines if name in asked]
    left = "; ".join(f"{say.word(name)} ({say.word(why)})" for name, why in record.left_out.items())
    # The curves have a key of their own.
    keys = [("#cdd3da", say("text.lifts")), ("#c3c6ca", say("text.band"))]
    pictures: list[Block] = [Drawing(rose(record, say).svg(say("text.rose")), style="chart-box")]
    pictures += [Drawing(scan, [say("text.scan_directions")], "plain-figure")] if scan else []
    told: list[Block] = [
        words(say, "amplitudes", most=say.short(record.study.search.most_g)), Legend(keys), words(say, "sides"),
        Details(say("text.seen_along_y"), [Drawing(scene_svg(record.scene, say), [record.scene.title])]),
    ]  # fmt: skip
    drawn = Chart("effects", say("text.changes"), changes(record, say), 1060)
    moving: list[Block] = [
        words(
            say, "replayed", azimuth=f"{say.short(chosen.azimuth_deg)}°", peak=say.value(chosen.peak_g, "g"),
            ends=say.listed(f"{say.word(end)} ({name})" for name, end in chosen.outcomes.items()),
        ),
        replay(source, [chip(name, engines, None, say) for name in engines]),
    ] if source and chosen and source.histories else []  # fmt: skip
    commands = [command_line("study", record.file), *([chosen.command] if chosen and chosen.command else [])]
    return [
        verdict(record),
        *section(say, "rose", Group("grid", [Group("", pictures), Group("", told)]),
            Details(say("text.rose_numbers"), [_rose(record, say)]),
        ),
        *section(say, "notes", *notes(say, record.findings)),
        *section(
            say, "effects", words(say, "effects"), Legend(colours), drawn,
            Details(say("text.effects_numbers"), [_effects(record, asked, say)]),
            words(say, "not_asked", "variant", what=left) if left else None,
        ),
        *section(say, "leaving", words(say, "leaving", share=say.short(100 * record.study.share)), _departures(record, say)),
        *moving,
        *repeat(say, record, *commands),
    ]  # fmt: skip


def _rose(record: EffectsRecord, say: Language) -> Table:
    """The rose as numbers: what lifts it, what overturns it in each model, and what a survey leaves open."""
    peaks = {
        name: {row.azimuth_deg: row.peak_g for row in record.amplitudes(name, BASELINE)} for name in record.engines
    }
    falls = {
        row.azimuth_deg: say(f"side.{row.outcome.removeprefix('overturned_')}")
        for row in record.amplitudes(record.solid_engine, BASELINE)
        if row.outcome.startswith("overturned_")
    }

    def peak(value: float | None) -> str:
        return say("ends.stands") if value is None else say.digits(value)

    between = {
        row.azimuth_deg: peak(row.low_g) + ("" if row.low_g is None else f"–{peak(row.high_g)}") for row in record.bands
    }
    rows = [
        [
            f"{say.short(at)}°", say.plain(item.lifts_g, 3), say.plain(item.projected_g, 3),
            *(peak(each[at]) if at in each else say("text.not_sent") for each in peaks.values()),
            between.get(at, "–"), falls.get(at, "–"),
        ]
        for item in record.static for at in [item.azimuth_deg]
    ]  # fmt: skip
    heads = ["", say("label.lifts_g"), say("label.projected_g"), *record.engines, say("label.band"), say("label.falls")]
    return Table(say("table.rose", share=say.short(100 * record.study.search.resolution)), heads, rows)


def _effects(record: EffectsRecord, asked: Sequence[str], say: Language) -> Table:
    """Each condition's change of the overturning amplitude in each model."""
    found = {(item.condition, item.engine): item for item in record.effects}
    groups = {item.condition: item.group for item in record.effects}
    rows = [
        [say.word(name), say(f"text.group_{group}"), *(_change(found.get((name, each)), say) for each in asked)]
        for name, group in groups.items()
    ]
    return Table(say("table.effects"), ["", say("label.group"), *asked], rows)


def _change(item: Effect | None, say: Language) -> str:
    """A condition's change in one model: the median, and the least and the largest of all directions."""
    if item is None or item.median is None:
        return say("text.not_seen" if item is None else "text.none_overturns")
    change, *ends = (f"{say.value(value, 'points')}\u00a0%" for value in (item.median, item.least, item.largest))
    return f"{change} ({say.range(ends)})" + (say("text.flips", count=item.flips) if item.flips else "")


def _departures(record: EffectsRecord, say: Language) -> Table | None:
    """How far the body in space leaves the plane of the shaking, by direction."""
    ends = {True: "overturns", False: "stands", None: "other"}
    rows = [
        {
            **vars(item), "azimuth": f"{say.short(item.azimuth_deg)}°", "walked_mm": 1000 * item.walked_m,
            "on_a_corner": say.percent(item.corner_share), "outcome": say(f"ends.{ends[item.outcome.fell]}"),
        }
        for item in record.departures if item.engine == record.solid_engine
    ]  # fmt: skip
    columns = "azimuth peak_g peak_theta_rad out_of_plane_rad yaw_rad yaw_left_rad walked_mm on_a_corner outcome"
    return table(say, "departures", columns, rows, "wrapped")
