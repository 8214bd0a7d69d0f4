"""Two histories from files, of whatever software, scored."""

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.comparison.comparator import compare
from harness.comparison.scores.pointwise import Measured
from harness.input.history_file import UNIFORM, between_samples, gaps, read_history
from harness.model import caution, machine, require, versions
from harness.records.result_folder import COMING, PAGES, RECORD, check_folder, check_inputs, write_whole
from harness.records.scores import FILES, CompareRecord, Scores


def compare_files(
    a: Path | str,
    b: Path | str,
    *,
    uncertainty_rad: float | None = None,
    slip_uncertainty_m: float | None = None,
    iso: bool = False,
    measured: Measured | None = None,
) -> Scores:
    """Score history file a against history file b, the reference, of whatever software; raises `InputError`.

    >>> scores = harness.compare_files("mine.csv", "theirs.csv")

    `uncertainty_rad` and `slip_uncertainty_m` are the numerical errors of either rotation and slip, where they are known.
    `measured` are the uncertainties where b is a measurement: a alone has a numerical error then.
    """
    require(
        slip_uncertainty_m is None or 0.0 <= slip_uncertainty_m < math.inf,
        "--slip-uncertainty",
        "a length from 0 m",
        f"{slip_uncertainty_m!r}",
    )
    require(
        uncertainty_rad is None or 0.0 <= uncertainty_rad < 1.0,
        "--uncertainty",
        "a rotation from 0 to 1 rad",
        f"{uncertainty_rad!r}",
    )
    a, b = Path(a), Path(b)
    histories = [read_history(a), read_history(b)]
    a_s, b_s = (history.t_s for history in histories)
    if a_s.size != b_s.size or not np.allclose(a_s, b_s, rtol=UNIFORM, atol=UNIFORM):
        # What lies open between samples counts as the history's resolution.
        histories = [
            replace(
                history,
                resolution_rad=history.resolution_rad + between_samples(history.theta_rad, history.t_s),
                resolution_m=history.resolution_m + between_samples(history.slip_m, history.t_s),
            )
            for history in histories
        ]
    scores = compare(
        *histories,
        names=(a.name, b.name) if a.name != b.name else (str(a), str(b)),
        uncertainties_rad=(uncertainty_rad, uncertainty_rad if measured is None else None),
        slip_uncertainties_m=(slip_uncertainty_m, slip_uncertainty_m),
        iso=iso,
        measured=measured,
    )
    begin_s, end_s = scores.compared_from_s, scores.compared_until_s
    if begin_s is not None and end_s is not None:
        where, got = f"{a.name} and {b.name}", f"one common instant at {begin_s:g} s"
        require(end_s > begin_s, where, "a common stretch of time", got, key="t_s")
    missing = [
        caution("no_samples", file=path.name, from_s=begin, until_s=end)
        for path, history in zip((a, b), histories, strict=True)
        for begin, end in gaps(history)
    ]
    return replace(scores, findings=(*scores.findings, *missing))


def write_comparison(a: Path, b: Path, scores: Scores, folder: Path, asked: Sequence[str] | None = None) -> None:
    """Write the scores of two files, by these options of the command, with both histories, into a result folder; raises
    `InputError` rather than lose a file."""
    names = [*PAGES, RECORD, COMING, *FILES]
    check_inputs(folder, names, (a, b))
    check_folder(folder, ("compare",), names)
    record = CompareRecord(
        title=f"{scores.a} against {scores.b}", scores=scores, asked=asked, versions=versions(), machine=machine()
    )

    def write(fresh: Path) -> None:
        for path, name in zip((a, b), FILES, strict=True):
            read_history(path).write_csv(fresh / name)

    write_whole(folder, record, write)
