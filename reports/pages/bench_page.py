"""The page of a bench (`harness/records/bench.py`): run time against error for every engine and setting."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from harness.records.bench import (
    DEFAULT,
    LEVEL,
    OTHER_PROJECT,
    TARGET,
    BenchRecord,
    Choice,
    PrecisionRow,
    ScalingRow,
    SkipRow,
)
from reports.blocks import (
    Block,
    Cell,
    Chart,
    Details,
    Section,
    Table,
    Text,
    Verdict,
    code,
    grid,
    notes,
    repeat,
    section,
    table,
    verdict,
    words,
)
from reports.charts import Json
from reports.charts.figure import BELOW, LOG, axis, curve, figure, level, stroke
from reports.charts.palette import INK, MUTED, look
from reports.messages import Language
from reports.messages.numbers import heading

SYMBOLS: Final = {LEVEL: "circle", TARGET: "star", DEFAULT: "square-open", OTHER_PROJECT: "diamond-open"}
WORDS: Final = {
    LEVEL: "",
    TARGET: "to the target",
    DEFAULT: "own defaults",
    OTHER_PROJECT: "another project's settings",
}

SIGNS: Final = {"duration_s": "circle", "mesh_vertices": "square", "runs": "diamond", "workers": "triangle-up"}
PANELS: Final = {"wall_s": ("y", [0.42, 1.0], "time  [s]"), "memory_mb": ("y2", [0.0, 0.34], "memory  [MB]")}
"""For each measure its axis, its part of the height and its title."""


def blocks(_folder: Path, record: BenchRecord, say: Language) -> list[Block]:
    """The blocks of a bench's page."""
    rows, scenes = record.rows, list(dict.fromkeys(row.scene for row in record.rows))
    work = [Chart(f"work-{k}", each, precision_figure(each, rows, record.target_rad)) for k, each in enumerate(scenes)]
    scaling: list[Block] = []
    if record.scaling:
        scaling = [
            words(say, "scaling"),
            Chart("scaling", say("text.scaling_chart"), scaling_figure(record.scaling), 760),
        ]
    sizes = [{**vars(row), "size": f"{row.engine}, {heading(row.quantity)}"} for row in record.scaling]
    covered = [
        {"engine": name, "inside": say("text.of", part=item.inside, whole=item.total), "missed_seed": item.missed}
        for name, item in record.coverage.items()
    ]
    return [
        bench_verdict(record),
        *section(say, "notes", *notes(say, record.findings)),
        *section(say, "work", words(say, "work"), grid(work)),
        *section(
            say, "choice", _choices(say, "target", record.choice, record.target_rad), _choices(say, "seeded", record.seeded),
            table(say, "coverage", "engine inside missed_seed", covered),
        ),
        *section(
            say, "skips", table(say, "skips", "skip scenes on_s off_s gain result", [_skip(row, say) for row in record.skips])
        ),
        *_others(record, say),
        *section(say, "scaling", *scaling, table(say, "scaling", "size value wall_s memory_mb", sizes)),
        *section(
            say, "rows", *(Details(each, [_rows(each, rows, say)], fold=k == 0) for k, each in enumerate(scenes))
        ),
        *repeat(say, record, record.command, more=[table(say, "parts", "part wall_s tasks left", record.parts)]),
    ]  # fmt: skip


def bench_verdict(record: BenchRecord) -> Verdict:
    """Who meets the target on every scene, and how fast on the slowest of them."""
    return verdict(record, "agree" if code(record) == "met" else "differ")


def _choices(say: Language, name: str, items: Sequence[Choice], target_rad: float = 0.0) -> Table | None:
    columns = "engine met total_s fixed_s share median_times worst_times worst_scene"
    rows = [{**vars(item), "met": say("text.of", part=item.met, whole=item.scenes)} for item in items]
    return table(say, name, columns, rows, target=f"{target_rad:g}")


def _skip(row: SkipRow, say: Language) -> dict[str, object]:
    """One skip's times, and what changed by it."""
    name = row.skip.replace("_", " ") + (f", {row.engine}" if row.engine != "*" else "")
    if row.failed:
        return {"skip": name, **dict.fromkeys(("scenes", "on_s", "off_s", "gain")), "result": row.failed}
    parts = ["; ".join(row.changed) or say("text.same")]
    parts += [] if row.apart_rad is None else [say("text.apart", apart=say.digits(row.apart_rad, 2))]
    result = ", ".join(parts) + (say("text.unsettled", count=len(row.unsettled)) if row.unsettled else "")
    return {**vars(row), "skip": name, "gain": row.gain, "result": result}


def _others(record: BenchRecord, say: Language) -> list[Section]:
    """The model beside other solvers of its equations, its outcomes by the second, and an engine's run over a bare loop."""
    solvers = [
        {**vars(row), "solver": ", ".join(filter(None, (row.solver, row.how))), "error_rad": row.failed or row.error_rad,
         "work": None if row.failed else row.work}
        for row in record.solvers
    ]  # fmt: skip
    outcomes = [
        {**vars(item), "kind": name.replace("_", " "), "per_core": item.runs_per_core_s}
        for name, item in record.throughput.items()
        if name != "map"
    ]
    kinds = [name.removesuffix("_ratio") for name in record.overhead if name.endswith("_ratio")]
    loops = [
        {
            "kind": kind.replace("_", " "),
            **{part: record.overhead[f"{kind}_{part}"] for part in ("run_s", "bare_s", "ratio")},
        }
        for kind in kinds
    ]
    cases = dict.fromkeys(row.case for row in record.solvers)
    by_case = [
        table(
            say,
            "solvers",
            "solver tolerance error_rad seconds work",
            [row for row in solvers if row["case"] == case],
            case=case,
        )
        for case in cases
    ]
    return section(
        say, "others", *by_case, table(say, "throughput", "kind per_core steps_per_run runs", outcomes),
        table(say, "overhead", "kind run_s bare_s ratio", loops),
    )  # fmt: skip


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


def precision_figure(scene: str, rows: Sequence[PrecisionRow], target_rad: float) -> Json:
    """Work–precision of one scene on logarithmic axes: one line per engine's levels, open signs for other settings."""
    here = [row for row in rows if row.scene == scene and row.failed is None and row.error_rad]
    engines = list(dict.fromkeys(row.engine for row in rows))
    data: list[Json] = []
    for engine in engines:
        style = look(engine, engines)
        for group, symbol in SYMBOLS.items():
            mine = sorted((row for row in here if (row.engine, row.group) == (engine, group)), key=_error)
            if not mine:
                continue
            marker = {"color": style.colour, "symbol": symbol, "size": [15 if row.chosen else 8 for row in mine]}
            data.append(
                curve(
                    [row.cpu_s for row in mine], [row.error_rad for row in mine], stroke(style) | {"width": 1.6},
                    mode="lines+markers" if group == LEVEL else "markers", marker=marker,
                    name=f"{engine} {WORDS[group]}".strip(), text=[row.label for row in mine],
                    hovertemplate=f"{engine}, %{{text}}: %{{y:.2e}} rad in %{{x:.3g}} s<extra></extra>",
                )
            )  # fmt: skip
    front = sorted((row for row in here if row.dt_s and on_front(row, here)), key=_error)
    best = {"name": "best contact engine", "opacity": 0.25, "hoverinfo": "skip"}
    line = {"color": MUTED, "width": 6, "shape": "hv"}
    data.append(curve([row.cpu_s for row in front], [row.error_rad for row in front], line, **best))
    shape = level(target_rad, {"color": INK, "dash": "dash", "width": 1})
    x, y = axis("time to compute  [s]", dtick=1, **LOG), axis("error  [rad]", dtick=2, **LOG)
    return figure(data, 600, x, y, margin_bottom=250, margin_top=20, shapes=[shape], legend=BELOW | {"y": -0.28})


def _error(row: PrecisionRow) -> float:
    return row.error_rad or 0.0


def scaling_figure(items: Sequence[ScalingRow]) -> Json:
    """Time above, peak memory below, on logarithmic axes; one line for each engine (colour) and quantity (sign)."""
    engines = list(dict.fromkeys(item.engine for item in items))
    data: list[Json] = [_proportional(items)]
    for engine, quantity in dict.fromkeys((item.engine, item.quantity) for item in items):
        mine = sorted((i for i in items if (i.engine, i.quantity) == (engine, quantity)), key=lambda i: i.value)
        style, words = look(engine, engines), heading(quantity)
        for measure, (place, _, _) in PANELS.items():
            data.append(
                curve(
                    [item.value / mine[0].value for item in mine], [getattr(item, measure) for item in mine],
                    stroke(style) | {"width": 1.6}, mode="lines+markers", name=f"{engine}, {words}",
                    legendgroup=f"{engine} {quantity}", showlegend=measure == "wall_s", xaxis="x", yaxis=place,
                    marker={"color": style.colour, "symbol": SIGNS[quantity], "size": 9},
                    text=[f"{item.value:g}" for item in mine],
                    hovertemplate=f"{engine}, {words} %{{text}}: %{{y:.3g}}<extra></extra>",
                )
            )  # fmt: skip
    time, memory = (axis(title, dtick=1, domain=domain, anchor="x", **LOG) for _, domain, title in PANELS.values())
    # Memory spans less than a decade: 20, 50, 100 are wanted as well.
    below = {"yaxis2": memory | {"dtick": "D2"}, "margin_bottom": 210, "margin_top": 20, "legend": BELOW | {"y": -0.14}}
    return figure(data, 720, axis("size, as a multiple of the smallest", dtick=1, anchor="y2", **LOG), time, **below)


def _proportional(items: Sequence[ScalingRow]) -> Json:
    """What grows with the size itself, from the least time of all."""
    by_line: dict[tuple[str, str], list[float]] = {}
    for item in items:
        by_line.setdefault((item.engine, item.quantity), []).append(item.value)
    most = max(max(values) / min(values) for values in by_line.values())
    least = min(item.wall_s for item in items)
    line = {"color": MUTED, "width": 6}
    rest = {"name": "in proportion", "xaxis": "x", "yaxis": "y", "opacity": 0.25, "hoverinfo": "skip"}
    return curve([1.0, most], [least, least * most], line, **rest)
