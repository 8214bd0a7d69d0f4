"""The tables of a bench: what the target takes, what each skip gains, other solvers, costs, the time of each part.

Each is a caption, heads and rows (a key and its values), empty where the record holds nothing of it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from harness.records.bench import (
    BenchRecord,
    Choice,
    Covered,
    PartRow,
    ScalingRow,
    SkipRow,
    SolverRow,
    Throughput,
)
from reports.text.numbers import digits, heading

Table = tuple[str, list[str], list[tuple[str, list[str]]]]


def tables(record: BenchRecord) -> dict[str, list[Table]]:
    """The tables by section, without those that are empty."""
    candidates = {
        "choice": [
            _choice(record.choice, f"What {record.target_rad:g} rad takes, its own checks included"),
            _choice(record.seeded, "The same on the seeded scenes that meet it to the end"),
            _coverage(record.coverage),
        ],
        "skips": [_skips(record.skips)],
        "others": [*_solvers(record.solvers), _throughput(record.throughput), _overhead(record.overhead)],
        "scaling": [_scaling(record.scaling)],
        "parts": [_parts(record.parts)],
    }
    return {name: [item for item in items if item[2]] for name, items in candidates.items()}


def _choice(items: Sequence[Choice], caption: str) -> Table:
    rows = [
        (
            str(item.engine),
            [
                f"{item.met}\u00a0of\u00a0{item.scenes}", digits(item.total_s, 2), digits(item.fixed_s, 2),
                digits(item.share, 2), digits(item.median_times, 2), digits(item.worst_times, 2),
                str(item.worst_scene or "–"),
            ],
        )
        for item in items
    ]  # fmt: skip
    heads = [
        "met",
        "all scenes [s]",
        "one fixed level that meets it [s]",
        "share",
        "over the best level: half",
        "most",
        "on",
    ]
    return caption, heads, rows


def _coverage(covered: Mapping[str, Covered]) -> Table:
    rows = [
        (name, [f"{item.inside} of {item.total}", ", ".join(map(str, item.missed)) or "–"])
        for name, item in covered.items()
    ]
    return "How often the error lies within what the engine states", ["scenes", "missed (seed)"], rows


def _skips(items: Sequence[SkipRow]) -> Table:
    rows = []
    for item in items:
        words = f"{item.skip.replace('_', ' ')}, {item.engine}".removesuffix(", *")
        if item.failed:
            rows.append((words, ["–", "–", "–", "–", str(item.failed)]))
            continue
        same = "; ".join(item.changed) or "the same"
        if item.apart_rad is not None:
            same += f", {digits(item.apart_rad, 2)} rad apart"
        if item.unsettled:
            same += f"; {len(item.unsettled)} that finer settings without skips change as well"
        times = [digits(value, 2) for value in (item.on_s, item.off_s, item.gain)]
        rows.append((words, [str(item.scenes), *times, same]))
    return "Skips: each alone, and all together", ["runs", "with [s]", "without [s]", "times faster", "result"], rows


def _solvers(items: Sequence[SolverRow]) -> list[Table]:
    lines = []
    heads = ["tolerance", "error [rad]", "time [s]", "steps or evaluations"]
    for case in dict.fromkeys(item.case for item in items):
        rows = [
            (
                ", ".join(word for word in (str(item.solver), item.how) if word),
                [digits(item.tolerance, 2), str(item.failed), "–", "–"]
                if item.failed
                else [digits(item.tolerance, 2), digits(item.error_rad, 2), digits(item.seconds, 2), str(item.work)],
            )
            for item in items
            if item.case == case
        ]  # fmt: skip
        lines.append((f"The analytic model and other solvers: {case}", heads, rows))
    return lines


def _throughput(rates: Mapping[str, Throughput]) -> Table:
    rows = [
        (
            name.replace("_", " "),
            [digits(item.runs_per_core_s, 3), digits(item.steps_per_run, 3), str(item.runs)],
        )
        for name, item in rates.items()
        if name != "map"
    ]
    return "Outcomes of the compiled model", ["a second and core", "steps a run", "runs timed"], rows


def _overhead(ratios: Mapping[str, float]) -> Table:
    kinds = [name.removesuffix("_ratio") for name in ratios if name.endswith("_ratio")]
    rows = [
        (kind.replace("_", " "), [digits(ratios[f"{kind}_{what}"], 3) for what in ("run_s", "bare_s", "ratio")])
        for kind in kinds
    ]
    return "A whole pymunk run over a baseline loop", ["run [s]", "baseline loop [s]", "ratio"], rows


def _scaling(items: Sequence[ScalingRow]) -> Table:
    rows = [
        (
            f"{item.engine}, {heading(str(item.quantity))}",
            [f"{item.value:g}", digits(item.wall_s, 2), digits(item.memory_mb, 3)],
        )
        for item in items
    ]
    return "How time and memory grow", ["size", "by the clock [s]", "memory [MB]"], rows


def _parts(items: Sequence[PartRow]) -> Table:
    rows = [(str(item.part), [digits(item.wall_s, 3), str(item.tasks), ", ".join(item.left) or "–"]) for item in items]
    return "Time of each part", ["by the clock [s]", "tasks", "not measured yet"], rows
