"""What a table of measurements holds, by its header, and which options go with it."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from harness.model.errors import InputError, Mistake
from harness.questions.validate import drop_run, impact_ratios, tosses
from harness.questions.validate.number_table import header

MEASURED: Final = {
    tosses.COLUMNS[0]: ("tosses", ("body", "engine")),
    drop_run.COLUMNS[0]: ("drops", ("body", "engine", "samples")),
    impact_ratios.COLUMNS[0]: ("impact_ratios", ()),
}
"""By the first column's name: the kind, and the options that it takes beside those of every table."""
OF_TESTS: Final = ("engine", "samples", "resume", "fit_share")


def kind_of(table: Path, **options: object) -> str:
    """`tests`, `tosses`, `drops` or `impact_ratios`. Raises `InputError` for options of another kind, and a body that is wanted.

    An option that is not given is None or False; `samples` 0.
    """
    kind, taken = MEASURED.get(header(table)[0], ("tests", OF_TESTS))
    mistakes = [
        Mistake(
            f"--{name.replace('_', '-')}", "", f"no such option with a table of {kind.replace('_', ' ')}", repr(value)
        )
        for name, value in options.items()
        if value and name not in taken
    ]
    if "body" in taken and options.get("body") is None:
        mistakes.append(Mistake("--body", "", f"the scene whose statue was thrown in {table}", "nothing"))
    if mistakes:
        raise InputError(mistakes)
    return kind
