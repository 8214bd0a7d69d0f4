"""The page of a bench (`harness/records/bench.py`): run time against error for every engine and setting."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from harness.records.bench import (
    TOGETHER,
    BenchRecord,
    LevelChoice,
    PrecisionRow,
    SkipRow,
)
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Details,
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
from reports.charts.curve_figures import on_front, precision_figure, scaling_figure
from reports.messages import Language


def blocks(_folder: Path, record: BenchRecord, say: Language) -> list[Block]:
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
