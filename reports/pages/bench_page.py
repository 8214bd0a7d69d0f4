"""The pages of what is measured of the engines (`harness/records/bench.py`).

A bench: run time against error for every engine and setting. A stress run: stability maps and hard scenes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.model import grouped
from harness.records.bench import (
    LEVEL,
    TARGET,
    TOGETHER,
    BenchRecord,
    HardRow,
    LevelChoice,
    Measure,
    PrecisionRow,
    ScalingRow,
    SkipRow,
    StabilityCell,
    StressRecord,
)
from harness.records.bench import StabilityCell as Found
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Details,
    Group,
    Table,
    Text,
    grid,
    notes,
    repeat,
    section,
    table,
    verdict,
    words,
)
from reports.charts.figure import (
    INK,
    MUTED,
    Json,
    Look,
    across,
    axis,
    chosen,
    columns,
    figure,
    filled,
    kinds,
    level,
    log,
    look,
    marks,
    named,
    names,
    rows_of,
    upwards,
    wrapped,
)
from reports.messages import ENGLISH, Language


def bench_page(_folder: Path, record: BenchRecord, say: Language) -> list[Block]:
    """The blocks of a bench's page."""
    rows = [replace(row, scene=say.word(row.scene)) for row in record.rows]
    scenes = list(dict.fromkeys(row.scene for row in rows))
    work = [
        Chart(f"work-{k}", each, precision_figure(each, rows, record.target_rad, say)) for k, each in enumerate(scenes)
    ]
    scaling: list[Block] = []
    if record.scaling:
        scaling = [
            words(say, "scaling"),
            Chart("scaling", say("text.scaling_chart"), scaling_figure(record.scaling, say), 760),
        ]
    sizes = [{**vars(row), "size": f"{row.engine}, {say.label(row.quantity)}"} for row in record.scaling]
    return [
        verdict(record),
        *section(say, "notes", *notes(say, record.findings)),
        *section(say, "work", words(say, "work"), grid(work)),
        *section(say, "choice", _choices(say, record.choice, record.target_rad)),
        *section(
            say, "skips", table(say, "skips", "skip scenes on_s off_s gain result", [_skip(row, say) for row in record.skips])
        ),
        *section(say, "scaling", *scaling, table(say, "scaling", "size value wall_s memory_mb", sizes)),
        *section(
            say, "rows", *(Details(each, [_rows(each, rows, say)], fold=k == 0) for k, each in enumerate(scenes))
        ),
        *repeat(say, record, record.command, more=[table(say, "parts", "part wall_s tasks left", record.parts)]),
    ]  # fmt: skip


def _choices(say: Language, items: Sequence[LevelChoice], target_rad: float) -> Table | None:
    columns = "engine met total_s fixed_s share median_times worst_times worst_scene"
    rows = [{**vars(item), "met": say("text.of", part=item.met, whole=item.scenes)} for item in items]
    return table(say, "target", columns, rows, target=say.short(target_rad))


def _skip(row: SkipRow, say: Language) -> dict[str, object]:
    """One skip's times, and what changed by it."""
    name = say.word(row.skip) if row.skip == TOGETHER else say(f"skip.{row.skip}")
    name += f", {row.engine}" if row.engine != "*" else ""
    if row.failed:
        return {"skip": name, **dict.fromkeys(("scenes", "on_s", "off_s", "gain")), "result": row.failed}
    parts = ["; ".join(row.changed) or say("text.same")]
    parts += [] if row.apart_rad is None else [say("text.apart", apart=say.digits(row.apart_rad, 2))]
    result = ", ".join(parts) + (say("text.unsettled", count=len(row.unsettled)) if row.unsettled else "")
    return {**vars(row), "skip": name, "gain": row.gain, "result": result}


def _rows(scene: str, rows: Sequence[PrecisionRow], say: Language) -> Block:
    """Every setting on one scene; in bold what nothing of its kind beats in both."""
    shown = [
        {
            **vars(row), "engine": Cell(row.engine, "front" if on_front(row, rows) else "broken" if row.failed else ""),
            "setting": f"{row.label} ◀" if row.chosen else row.label, "error_rad": row.failed or row.error_rad,
        }
        for row in rows if row.scene == scene
    ]  # fmt: skip
    columns = "engine setting dt_s error_rad cpu_s steps real_time_factor stated_rad"
    return table(say, "precision", columns, shown, "bench", scene=scene) or Text([])


SHAPES: Final = {LEVEL: "circle", TARGET: "diamond"}


QUANTITIES: Final = {"duration_s": "circle", "mesh_vertices": "square", "runs": "diamond", "workers": "triangle-up"}


PANELS: Final = {"wall_s": 330.0, "memory_mb": 200.0}
"""For each measure its height."""


def on_front(row: PrecisionRow, rows: Sequence[PrecisionRow]) -> bool:
    """Whether no other setting of its kind on the same scene is both faster and more accurate.

    Contact engines, which have a step, compete with each other; the analytic model, which has none, would leave no front.
    An error of exactly nothing is that of a run compared with itself: it stands in the table only.
    """
    if not row.error_rad or row.failed is not None:
        return False
    mine = row.error_rad, row.cpu_s or 0.0
    others = [
        (other.error_rad, other.cpu_s or 0.0)
        for other in rows
        if other.scene == row.scene and bool(other.dt_s) == bool(row.dt_s) and other.failed is None and other.error_rad
    ]
    return not any(error <= mine[0] and cost <= mine[1] and (error, cost) != mine for error, cost in others)


def shapes(known: Mapping[str, str], key: bool = True) -> Json:
    """A sign for each kind, with a key of them."""
    scale = {"domain": list(known), "range": list(known.values())}
    legend = {"symbolFillColor": MUTED, "symbolStrokeWidth": 0, **wrapped(known)} if key else None
    return {"shape": {"field": "kind", "type": "nominal", "scale": scale, "legend": legend}}


def precision_figure(scene: str, rows: Sequence[PrecisionRow], target_rad: float, say: Language = ENGLISH) -> Json:
    """Work–precision of one scene on logarithmic axes: a line for each engine's levels, other signs for other settings."""
    known = (row for row in rows if row.scene == scene and row.failed is None and row.error_rad)
    here = sorted(known, key=lambda row: row.error_rad or 0.0)
    engines = list(dict.fromkeys(row.engine for row in rows))
    words = {group: say(f"chart.group_{group}") for group in SHAPES}
    tips = {
        row: say(
            "chart.setting",
            name=row.engine,
            setting=row.label,
            error=say.digits(row.error_rad),
            time=say.digits(row.cpu_s or 0.0),
        )
        for row in here
    }
    parts: list[Json] = [
        {
            "name": engine, "kind": words[group],
            **columns("x y size tip", [(row.cpu_s, row.error_rad, 170 if row.chosen else 55, tips[row]) for row in mine]),
        }
        for engine in engines for group in SHAPES
        for mine in [[row for row in here if (row.engine, row.group) == (engine, group)]] if mine
    ]  # fmt: skip
    front = [row for row in here if row.dt_s and on_front(row, here)]
    met = {
        words[group]: shape for group, shape in SHAPES.items() if any(part["kind"] == words[group] for part in parts)
    }
    drawn = named({engine: look(engine, engines) for engine in engines})
    size = {"size": {"field": "size", "type": "quantitative", "scale": None, "legend": None}}
    order = {"order": {"field": "y", "type": "quantitative"}}
    data = {
        "settings": parts, "levels": [part for part in parts if part["kind"] == words[LEVEL]],
        "front": [columns("x y", [(row.cpu_s, row.error_rad) for row in front])],
    }  # fmt: skip
    layers = [
        marks("line", "front", order, color=MUTED, strokeWidth=6, opacity=0.25, interpolate="step-after"),
        *chosen([marks("line", "levels", drawn | order)]),
        marks("point", "settings", filled(drawn) | shapes(met) | size, filled=True, strokeWidth=0),
        *level(target_rad, say("chart.target"), line=Look(INK, "6 4", 1.0)),
    ]
    x, y = across("x", say("chart.cpu_s"), log(), **POWERS), upwards("y", say("chart.error_rad"), log(), **POWERS)
    return figure(layers, 460, data, x, y)


POWERS: Final = {"format": ".0e", "tickCount": 5}
"""How the powers of ten of a logarithmic axis are written."""


def scaling_figure(items: Sequence[ScalingRow], say: Language = ENGLISH) -> Json:
    """Time above, peak memory below, on logarithmic axes; one line for each engine (colour) and quantity (sign)."""
    engines = list(dict.fromkeys(item.engine for item in items))
    looks = {engine: look(engine, engines) for engine in engines}
    parts: list[Json] = []
    for engine, quantity in dict.fromkeys((item.engine, item.quantity) for item in items):
        mine = sorted((i for i in items if (i.engine, i.quantity) == (engine, quantity)), key=lambda i: i.value)
        sizes = [(item.value / mine[0].value, item.wall_s, item.memory_mb) for item in mine]
        parts.append({"name": engine, "kind": say.label(quantity), **columns("x wall_s memory_mb", sizes)})
    met = {say.label(name): shape for name, shape in QUANTITIES.items() if any(item.quantity == name for item in items)}
    most, least = max(max(part["x"]) for part in parts), min(item.wall_s for item in items)
    data = {"sizes": parts, "proportional": [{"x": [1.0, most], "wall_s": [least, least * most]}]}
    rows: list[tuple[list[Json], float]] = []
    for key, height in PANELS.items():
        y, drawn = axis(key, say(f"chart.{key}"), scale=log(), tickCount=5), named(looks, legend=not rows)
        signs = {"y": y} | filled(drawn) | shapes(met, key=not rows)
        layers = [
            marks("line", "sizes", {"y": y} | drawn | {"detail": {"field": "kind"}}),
            marks("point", "sizes", signs, filled=True, size=60, strokeWidth=0),
        ]
        if not rows:
            layers = [
                *chosen(layers),
                marks("line", "proportional", {"y": y}, color=MUTED, strokeWidth=6, opacity=0.25),
            ]
        rows.append((layers, height))
    return rows_of(rows, across("x", say("chart.size"), log(), tickCount=4), data)


# A stress run: each engine's stability map and the hard scenes.


def stress_page(_folder: Path, record: StressRecord, say: Language) -> list[Block]:
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
    """What avoids it, where something does."""
    return say(f"text.remedy_{cell.remedy}", stable=cell.stable)


def explanations(engine: str, cells: Sequence[Found], say: Language) -> list[str]:
    """Each explanation of an engine's map once, with the difficulty and the settings that it explains."""
    avoided = [cell for cell in cells if cell.engine == engine and cell.remedy]
    by_note = grouped(((cell.difficulty, _avoided(cell, say)), cell.setting) for cell in avoided)
    return [f"{difficulty}, {'; '.join(settings)}: {text}" for (difficulty, text), settings in by_note.items()]


STABILITY: Final = {
    "stable": ("●", "#bfdef2"), "inaccurate": ("◐", "#f3e96b"), "drifting": ("↗", "#f0b03d"), "diverged": ("✕", "#e0566b"),
}  # fmt: skip
"""What becomes of a hard scene, its sign and its colour."""


def stability_figure(cells: Sequence[StabilityCell], tips: Sequence[str], say: Language = ENGLISH) -> Json:
    """What becomes of hard scenes, by difficulty (rows) and setting; `tips` say more of each cell."""
    words = {name: f"{sign} {say(f'text.{name}')}" for name, (sign, _) in STABILITY.items()}
    found = [
        (
            cell.setting, cell.difficulty, words[cell.category],
            f"{STABILITY[cell.category][0]}{'*' if cell.remedy else ''}{'°' if cell.short else ''}", tip,
        )
        for cell, tip in zip(cells, tips, strict=True)
    ]  # fmt: skip
    settings, difficulties, *_ = (list(dict.fromkeys(column)) for column in zip(*found, strict=True))
    colour = kinds({words[name]: colour for name, (_, colour) in STABILITY.items()})
    layers = [
        marks("rect", "cells", {"color": colour}, stroke="#ffffff"),
        marks("text", "cells", {"text": {"field": "sign"}}),
    ]
    x, y = names("x", settings, labelAngle=0, grid=False), names("y", difficulties, grid=False)
    return figure(layers, 44 * len(difficulties), {"cells": [columns("x y kind sign tip", found)]}, x, y)
