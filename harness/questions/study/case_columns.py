"""Cases of a study by the analytic model as columns, and columns as the records that a store of single runs holds."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.solution import LEFT_BY, OUTCOMES, peak_is_ahead
from analytic.sweep import CertifiedRows, certify_rows
from harness.engines import analytic as twoblock
from harness.engines.base import RELIABLE_RAD
from harness.model.history import Outcome
from harness.model.run import NUMBERS, to_plain
from harness.model.run_set import column_of
from harness.model.scene import BaseExcitation
from harness.questions.study.cases import StillScene
from harness.questions.study.file import StudyFile, Value
from harness.records.base import Plain

Columns = dict[str, NDArray[Any]]
RUN: Final = {name: name for name in ("overturn_time_s", "peak_slip_m")}
VALIDITY: Final = {
    "energy_gained_j": "energy_gained_j",
    "energy_lost_j": "energy_lost_j",
    "floor_normal_least_n": "least_floor_normal_n",
    "left_domain_s": "left_domain_s",
    "statue_friction_needed": "pivot_friction",
    "statue_friction_needed_at_impact": "pivot_friction_at_impact",
    "statue_normal_least_n": "least_pivot_normal_n",
}
TIPPING: Final = {
    "pedestal_tipping_margin_at_impact_m": "tipping_margin_at_impact_m",
    "pedestal_tipping_margin_m": "tipping_margin_m",
}
"""Names of a run's record, and of what the kernel leaves behind; the last only where there is a pedestal."""
WORK: Final = {"events": "events", "impacts": "impacts", "taylor_coefficients": "coefficients"}
OF_RUN: Final = (*NUMBERS, "outcome", "findings", "skipped", "steps")
"""Columns that stand in the record itself."""
TABLES: Final = ("skipped", "findings")
"""Columns that hold JSON."""
OF_VALIDITY: Final = ("left_domain_by", "peak_over_slenderness", *VALIDITY)


class Shaken(NamedTuple):
    """A case as the model reads it, and its place among others."""

    place: int
    still: StillScene
    motion: BaseExcitation


def swept(cases: Sequence[Shaken]) -> Columns:
    """Run the cases; what their records hold, as columns (n,), with their places."""
    stills = list({id(case.still): case.still for case in cases}.values())
    numbers = {id(still): k for k, still in enumerate(stills)}
    which = np.array([numbers[id(case.still)] for case in cases])
    motions = [(case.motion.x, case.motion.z) for case in cases]
    rows = certify_rows([still.body for still in stills], which, motions, RELIABLE_RAD)
    slender = np.array([[still.scene.statue.slenderness_rad(side) for side in (-1, 1)] for still in stills])[which]
    pedestal = np.array([still.scene.pedestal is not None for still in stills])[which]
    certified = [rows.certified(k) for k in range(len(cases))]
    findings = [
        (*twoblock.findings_of(each), *twoblock.left_out(case.motion))
        for each, case in zip(certified, cases, strict=True)
    ]
    return {
        "place": np.array([case.place for case in cases]),
        **_numbers(rows, slender, pedestal),
        "motion_axes": column_of(["".join(case.motion.axes(2)) for case in cases]),
        "findings": column_of([_json(each) for each in findings]),
        "skipped": column_of([_json(twoblock.skipped(each.solution, keep=False)) for each in certified]),
        "record": column_of([None] * len(cases)),
    }


def _json(value: object) -> str:
    return json.dumps(to_plain(value))


def _numbers(rows: CertifiedRows, slenderness_rad: NDArray[np.float64], pedestal: NDArray[np.bool_]) -> Columns:
    """Of α (n, 2) the left and the right side."""
    states, results, counts = rows.first.states, rows.first.results, rows.first.counts
    signed = results["peak_theta_rad"]
    peak = np.abs(signed)
    ahead = peak_is_ahead(counts["energy_endings"], results["peak_time_s"], states["time_s"])
    falls = np.isin(states["outcome"], [k for k, item in enumerate(OUTCOMES) if Outcome(item.value).overturned])
    columns: Columns = {name: np.full(peak.size, value) for name, value in NUMBERS.items()}
    columns |= {
        "outcome": column_of([OUTCOMES[code].value for code in states["outcome"].tolist()]),
        "end_s": states["time_s"],
        "peak_theta_rad": peak,
        "peak_time_s": np.where(ahead, np.nan, results["peak_time_s"]),
        "residual_slip_m": states["slip_m"],
        "no_return_time_s": np.where(falls, results["no_return_time_s"], np.nan),
        "numerical_uncertainty_rad": rows.uncertainty_rad,
        "slip_uncertainty_m": rows.slip_uncertainty_m,
        "reliable_until_s": rows.reliable_until_s,
        "steps": counts["steps"],
        "left_domain_by": column_of([LEFT_BY[code] for code in results["left_domain_by"].tolist()]),
        "peak_over_slenderness": peak / np.where(signed > 0.0, slenderness_rad[:, 1], slenderness_rad[:, 0]),
        "on_pedestal": pedestal,
    }
    columns |= {name: results[source] for name, source in {**RUN, **VALIDITY}.items()}
    columns |= {name: np.where(pedestal, results[source], np.nan) for name, source in TIPPING.items()}
    return columns | {name: counts[source] for name, source in WORK.items()}


def columns_of_record(record: Plain) -> Columns:
    """One run's record as columns of one row: what of it other rows have too, and the whole as text."""
    numbers = {name: record.get(name) for name in OF_RUN if name not in TABLES}
    own = {name: np.array([np.nan if value is None else value]) for name, value in numbers.items()}
    lists = {name: column_of([json.dumps(record[name])]) for name in TABLES}
    words = {"outcome": record["outcome"], "left_domain_by": "", "motion_axes": "", "record": json.dumps(record)}
    said = {name: column_of([value]) for name, value in words.items()}
    nothing = {name: np.array([np.nan]) for name in (*VALIDITY, *TIPPING, "peak_over_slenderness")}
    counts = {name: np.array([0]) for name in WORK}
    return {**own, **nothing, **counts, **said, **lists, "on_pedestal": np.array([False])}


def varied_column(study: StudyFile, key: str, values: list[Value]) -> NDArray[Any]:
    """What varies as a column: numbers of one kind as they are, anything else as JSON; alike in every block of the study."""
    given = next((item.values for item in study.vary if item.key == key), None)
    kinds = {type(value) for value in given} if given is not None else {float}
    return np.array(values) if kinds in ({float}, {int}) else column_of([json.dumps(value) for value in values])


def rows_of(table: Columns, block: Plain) -> Iterator[tuple[int, dict[str, Value], Plain]]:
    """Number, what varies and record of each row of a block: the record that a store of single runs would hold."""
    named = {name: _plain(values) for name, values in table.items()}
    keys: Any = block["varied"]
    for row in (dict(zip(named, values, strict=True)) for values in zip(*named.values(), strict=True)):
        varied = {key: json.loads(row[key]) if isinstance(row[key], str) else row[key] for key in keys}
        record = _record(row, block["settings"]) if row["record"] is None else json.loads(row["record"])
        # By name, as a store has them.
        yield row["number"], dict(sorted({"variant": row["variant"], **varied}.items())), dict(sorted(record.items()))


def _plain(values: NDArray[Any]) -> list[Any]:
    """A column's values; a number that is not finite is None, as it is in a record."""
    if values.dtype.kind != "f":
        return list(values.tolist())
    column = values.astype(object)
    column[~np.isfinite(values)] = None
    return list(column)


def _record(row: Mapping[str, Any], settings: Any) -> Plain:
    """The record of one run; what it has that no outcome of the model has is empty."""
    validity = {name: row[name] for name in OF_VALIDITY}
    if row["on_pedestal"]:
        validity |= {name: row[name] for name in TIPPING}
    if row["outcome"] == Outcome.TOUCHES_WALL.value and row["peak_time_s"] is not None:
        validity["wall_touch_time_s"] = row["end_s"]
    return {
        "engine": twoblock.TwoBlock.name,
        "impact_times_s": [],
        "interventions": {},
        "labels": [],
        "message": "",
        "motion_axes": list(str(row["motion_axes"])),
        "patterns": [],
        "settings": settings,
        "uplift_times_s": [],
        "validity": {**validity, "impact_ratios": [], "several_joint_states_s": []},
        "work": {name: row[name] for name in WORK},
        **{name: row[name] for name in OF_RUN if name not in TABLES},
        **{name: json.loads(str(row[name])) for name in TABLES},
    }
