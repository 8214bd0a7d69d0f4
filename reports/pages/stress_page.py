"""The page of a stress run (`harness/records/bench.py`): each engine's stability map and the hard scenes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.model import grouped
from harness.records.bench import HardRow, Measure, StressRecord
from harness.records.bench import StabilityCell as Found
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Details,
    Group,
    Table,
    Text,
    notes,
    repeat,
    section,
    verdict,
    words,
)
from reports.charts.map_figures import stability_figure
from reports.messages import Language


def blocks(_folder: Path, record: StressRecord, say: Language) -> list[Block]:
    """The blocks of a stress run's page."""
    cells = [replace(cell, difficulty=say.word(cell.difficulty)) for cell in record.cells]
    engines = list(dict.fromkeys(cell.engine for cell in cells))
    tried = list(dict.fromkeys(name for scene in record.scenes for name in scene.got))
    scenes = Table(
        say("table.hard"), [say("label.scene"), say("label.wanted"), *tried, say("label.checked")],
        [_scene(scene, tried, say) for scene in record.scenes], "claims",
    )  # fmt: skip
    return [
        verdict(record),
        *section(say, "notes", *notes(say, record.findings)),
        *section(say, "scenes", scenes if record.scenes else None),
        *section(say, "maps", words(say, "signs"), *(_map(engine, cells, say) for engine in engines)),
        *repeat(say, record, record.command),
    ]  # fmt: skip


def measured(each: Measure, say: Language) -> str:
    """A check in words: what was measured, of how much."""
    checked, unit = say.named(each.check)
    name = f"{checked} ({say.word(each.case)})" if each.case else checked
    if each.value is None:
        return f"{name}: {say('text.holds' if each.holds else 'text.fails')}"
    allowed = say.plain(each.allowed, 2)
    until = "" if each.until_s is None else say("text.while_model", until=say.value(each.until_s, "s"))
    return f"{name}: {say('text.of', part=say.plain(each.value, 2), whole=allowed)} {unit}".rstrip() + until


def _listed(measures: Sequence[Measure], say: Language) -> list[str]:
    return [measured(each, say) for each in measures]


def _scene(scene: HardRow, engines: Sequence[str], say: Language) -> list[str | Cell]:
    """A hard scene's row: what must come, what each engine gave, what is known of its failures."""
    known = [
        Details(say("text.known", name=name), [Text([
            say("text.more_iterations", count=each.iterations, tried=say.value(each.tried_s, "s")),
            *_listed(each.checks, say),
        ])])
        for name, each in scene.known.items()
    ]  # fmt: skip
    checks = [f"{name}: {text}" for name, found in scene.checks.items() for text in _listed(found, say)]
    folded = [Details(say("text.checks", count=len(checks)), [Text(checks, "notes")])] if checks else []
    named = Cell(say.word(scene.name), below=say.word(scene.note), folds=known)
    return [named, say.word(scene.wanted), *(_given(scene, name, say) for name in engines), Cell(folds=folded)]


def _given(scene: HardRow, name: str, say: Language) -> Cell:
    """What an engine gave of a hard scene, and whether that is right."""
    if name not in scene.got:
        return Cell("–")
    text = "; ".join([say.word(scene.got[name]), *_listed(scene.failed(name), say)])
    style, sign = ("claim holds", "✓") if scene.right(name) else ("claim does-not-hold", "✕")
    return Cell(f"{text}*" if name in scene.known else text, style, sign=sign)


def _map(engine: str, cells: Sequence[Found], say: Language) -> Group:
    """An engine's stability map, what explains it, and the evidence of every cell, which stands under the pointer too."""
    mine = [cell for cell in cells if cell.engine == engine]
    evidence = [
        f"{cell.difficulty}, {cell.setting}: {say(f'text.{cell.category}')}, {evidence_of(cell, say)}"
        + (f" ({_avoided(cell, say)})" if cell.remedy else "")
        for cell in mine
    ]
    drawn, words = stability_figure(mine, evidence, say), say("chart.stability", engine=engine)
    explained = Text([f"* {text}" for text in explanations(engine, cells, say)], "variant")
    more = Details(say("text.evidence"), [Text(evidence, "plan")])
    return Group("", [Chart(f"stability-{engine.replace(':', '-')}", words, drawn, 1060), explained, more], engine)


def evidence_of(cell: Found, say: Language) -> str:
    """What was measured of a cell, or what its engine said."""
    return "; ".join(filter(None, [*_listed(cell.evidence, say), say.word(cell.message)]))


def _avoided(cell: Found, say: Language) -> str:
    """What avoids it."""
    return "" if cell.remedy is None else say(f"text.remedy_{cell.remedy}", stable=cell.stable)


def explanations(engine: str, cells: Sequence[Found], say: Language) -> list[str]:
    """Each explanation of an engine's map once, with the difficulty and the settings that it explains."""
    avoided = [cell for cell in cells if cell.engine == engine and cell.remedy]
    by_note = grouped(((cell.difficulty, _avoided(cell, say)), cell.setting) for cell in avoided)
    return [f"{difficulty}, {'; '.join(settings)}: {text}" for (difficulty, text), settings in by_note.items()]
