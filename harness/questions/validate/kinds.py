"""What a table of measurements holds, by its header: which options go with it, and one call that scores all but tests."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Final

from harness.input.paths import read_files
from harness.model import run as record
from harness.model.errors import InputError, Mistake
from harness.model.finding import Say
from harness.questions.validate import drops, impact_ratios, tosses
from harness.questions.validate.measured_set import MeasuredSet, Told, body_alone, header
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.validation import About, MeasuredRecord
from harness.runs.progress import progress
from harness.runs.runner import LocalPool

MEASURED: Final[Mapping[str, tuple[About, Sequence[str], Callable[[MeasuredSet], Told]]]] = {
    tosses.COLUMNS[0]: ("tosses", ("body", "engine"), tosses.scored_tosses),
    drops.COLUMNS[0]: ("drops", ("body", "engine", "samples"), drops.scored_drops),
    impact_ratios.COLUMNS[0]: ("impact_ratios", (), impact_ratios.scored_ratios),
}
"""By the first column's name: the kind, the options that it takes beside those of every table, and what scores it."""
OF_TESTS: Final = ("engine", "samples", "resume", "fit_share")


def kind_of(table: Path, **options: object) -> str:
    """`tests`, `tosses`, `drops` or `impact_ratios`. Raises `InputError` for options of another kind, and a body that is wanted.

    An option that is not given is None or False; `samples` 0.
    """
    kind, taken, _ = MEASURED.get(header(table)[0], ("tests", OF_TESTS, None))
    mistakes = [
        Mistake(
            f"--{name.replace('_', '-')}", "", f"no such option with a table of {kind.replace('_', ' ')}", str(value)
        )
        for name, value in options.items()
        if value and name not in taken
    ]
    if "body" in taken and options.get("body") is None:
        mistakes.append(Mistake("--body", "", f"the scene whose statue was thrown in {table}", "nothing"))
    if mistakes:
        raise InputError(mistakes)
    return kind


def validate_measured(
    table: Path,
    folder: Path,
    *,
    body: Path | None = None,
    models: Sequence[str] | None = None,
    samples: int = 0,
    seed: int = 0,
    jobs: int | None = None,
    quiet: bool = False,
    say: Say = str,
) -> MeasuredRecord:
    """Hold models against a table of measured tosses, drops or impact ratios; writes result.json into `folder`.

    `body` is a scene file whose statue was thrown; what is fitted is fitted on a seeded third, and scored on the others. Raises
    `InputError` for a wrong table, scene, model or number.
    """
    start_s, (about, _, scored) = time.perf_counter(), MEASURED[header(table)[0]]
    base = None if body is None else body_alone(body)
    names = [RECORD, COMING, *PAGES]
    check_folder(folder, ("measured",), names)
    check_inputs(folder, names, [table, *([] if base is None else read_files(base.given, base.source))])
    with closing(LocalPool(jobs)) as pool, progress(table.name, quiet) as on_progress:
        told = scored(MeasuredSet(table, base, models or (), samples, seed, pool, on_progress))
    result = MeasuredRecord(
        **vars(told),
        about=about,
        source=table.name,
        body=None if body is None else body.name,
        seed=seed,
        versions=record.versions(),
        machine=record.machine(),
        seconds=time.perf_counter() - start_s,
    )
    return write_whole(folder, result.texted(say))
