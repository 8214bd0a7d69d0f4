"""The bench: all measurements in parts that can be interrupted, one record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from harness.bench import coverage as cover
from harness.bench import other_integrators as others
from harness.bench import precision, scaling, sentences, skips
from harness.bench import skip_savings as alone
from harness.bench.standard_scenes import standard_set
from harness.campaign import parts
from harness.campaign.parts import Measured, Part, Row
from harness.model.run import SCHEMA_VERSION

CLOCK: Final = "cpu_s: processor time of the process (single-threaded runs); wall_s: by the clock; both best of several"


def run(
    folder: Path,
    quick: bool = False,
    told: Callable[[str], None] = lambda text: None,
    only: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Measure everything (or `only` some parts) and write `result.json` into `folder`; `quick` takes the first of each kind.

    What was interrupted goes on where it was. `told` hears what is at work. Raises `InputError` for a folder that cannot be
    written, or an unknown part.
    """
    listed = all_parts(quick)
    measured = parts.session(folder, listed, quick, only, told)
    found = assembled(listed, measured) | {"command": parts.command("bench", quick, measured)}
    return parts.written(folder, found)


def all_parts(quick: bool) -> list[Part]:
    """The parts as they are measured: by processor time on all cores, then those that are timed by the clock, alone."""
    return [
        Part("precision", precision.tasks(quick), partial(precision.of, quick), precision.died),
        Part("coverage", cover.tasks(quick), cover.compute, cover.died),
        Part("skips", skips.tasks(quick), skips.compute),
        Part("alone", alone.tasks(quick), alone.compute),
        Part("scaling", scaling.tasks(quick), scaling.compute),
        Part("others", others.tasks(), partial(others.compute, quick)),
    ]


def assembled(listed: Sequence[Part], measured: dict[str, Measured]) -> dict[str, Any]:
    """The record from the rows of all parts; what is not measured yet is left empty and said."""
    rows = {part.name: measured[part.name].in_order(part) for part in listed}
    absent = {row["scene"]: row["absent"] for row in rows["precision"] if "absent" in row}
    order = [item.name for item in standard_set()]
    timed = sorted((row for row in rows["precision"] if "absent" not in row), key=lambda row: order.index(row["scene"]))
    seeded = [cover.Coverage.read(row) for row in rows["coverage"]]
    spent = parts.seconds(measured)
    found: dict[str, Any] = {
        "schema_version": SCHEMA_VERSION,
        "kind": "bench",
        "title": "Run time against error",
        "target_rad": precision.TARGET_RAD,
        "clock": CLOCK,
        "rows": timed,
        "absent": absent,
        "choice": sentences.choice(timed, precision.TARGET_RAD),
        "seeded": sentences.choice(cover.choice_rows(seeded), precision.TARGET_RAD),
        "coverage_rows": rows["coverage"],
        "coverage": cover.counted(seeded),
        "skips": [*skips.together(rows["skips"]), *rows["alone"]],
        "scaling": rows["scaling"],
        **others.collected(rows["others"]),
        "parts": spent,
        "seconds": sum(item["wall_s"] for item in spent),
    }
    found["sentences"] = [*said(found), *parts.sentences(spent)]
    return found


def said(found: Row) -> list[str]:
    """Every sentence that the rows hold."""
    return [
        *sentences.sentences(found),
        *alone.sentences(found["skips"]),
        *scaling.sentences(found["scaling"]),
        *others.sentences(found),
        *(f"“{name}” was left out: {why}." for name, why in found["absent"].items()),
    ]
