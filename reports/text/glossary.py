"""What a record's keys mean, in the words of a page; keys not named here are shown as they stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Final

from harness.model.finding import info
from harness.records.base import Table
from harness.records.scores import AfterHorizon, Scores
from reports.messages import ENGLISH, Language
from reports.messages.numbers import digits, split_unit

SCORES: Final = (
    "together_until_s together_tolerance_rad horizon_s compared_until_s rms_theta_rad largest_difference_rad peak_theta_a_rad "
    "peak_theta_b_rad peak_ratio peak_time_difference_s uplift_time_differences_s impact_times_a_s impact_time_differences_s "
    "impacts_alone_a impacts_alone_b uplifts_alone_a uplifts_alone_b impact_energy_lost_a_j impact_energy_lost_b_j "
    "impact_energy_share_lost_a impact_energy_share_lost_b rms_slip_m residual_slip_difference_m residual_theta_difference_rad "
    "magnitude phase combined no_return_time_difference_s coverage outcome_agrees side_agrees after_horizon"
)
"""The scores in the order of the table; any other follows."""
LISTED: Final = 6
"""Items of a list that fit on a terminal's line."""
SCORES_LEFT_OUT: Final = frozenset(
    {
        *("a", "b", "outcome_a", "outcome_b", "verdict", "verdict_sentence", "compared_from_s"),
        *("numerical_uncertainty", "evidence", "iso", "findings"),
    }
)
"""Keys whose content stands elsewhere on the page, or in the record alone."""


def score_rows(scores: Mapping[str, Scores], say: Language = ENGLISH) -> list[tuple[str, str, list[str]]]:
    """The table of scores: words, meaning, one cell per pair; each with its numerical uncertainty where it is stated."""
    keys = dict.fromkeys([*SCORES.split(), *(each.name for each in fields(Scores))])
    rows = []
    for key in keys:
        values = [getattr(item, key) for item in scores.values()]
        if key not in SCORES_LEFT_OUT and not all(value is None or value == [] for value in values):
            cells = [_score(item, key, say) for item in scores.values()]
            rows.append((say.label(key), say.strings.get(f"meaning.{key}", ""), cells))
    return rows


def scores_text(pair: str, scores: Scores) -> str:
    """One pair's scores as lines for a terminal: the verdict and what is to be said beside it, a table in words."""
    lines = [f"{pair.replace('_vs_', ' against ')}:", *(f"  {ENGLISH.say(each)}" for each in scores.findings)]
    rows = [(words, _short(cells[0])) for words, _, cells in score_rows({pair: scores})]
    if scores.iso is not None:
        rows.append((ENGLISH.label("iso"), digits(scores.iso.overall, 4)))
    width = max((len(words) for words, _ in rows), default=0)
    return "\n".join([*lines, *(f"  {words:{width}}  {cell}" for words, cell in rows)])


def _short(cell: str) -> str:
    """A list too long for a line is counted."""
    count = cell.count(", ") + 1
    return cell if count <= LISTED else f"{count} of them (see --json)"


def _score(scores: Scores, key: str, say: Language) -> str:
    value, uncertainty = getattr(scores, key), scores.numerical_uncertainty.get(key)
    if isinstance(value, AfterHorizon):
        return say.say(info("after_horizon", **after_horizon_values(value)))
    return say.plain(value) + (
        "" if uncertainty is None or value is None else f" ± {say.digits(float(uncertainty), 2)}"
    )


def after_horizon_values(item: AfterHorizon) -> dict[str, object]:
    """What two histories are beyond the horizon, as its sentence wants it: whether chance alone would part them as far."""
    peaks = item.peaks
    chance = None if peaks is None else peaks.area_by_chance_rad
    more = None if peaks is None or chance is None else peaks.area_rad > chance
    return {
        "from_s": item.from_s,
        "until_s": item.until_s,
        "area_rad": item.rotation.area_rad,
        "peaks_rad": None if peaks is None else peaks.area_rad,
        "chance_rad": chance,
        "kind": "few" if more is None else "more" if more else "chance",
    }


def validity_rows(
    validity: Table, before: Mapping[str, float], until_s: float | None, say: Language = ENGLISH
) -> Sequence[tuple[str, str]]:
    """The limits met in one run: words and value with unit; what did not happen is left out.

    `before` holds values until the outcome was decided, at `until_s`, which are told beside those of the whole run.
    """
    rows = []
    for key, value in validity.items():
        if value is None or value in ("", []):
            continue
        words, name = split_unit(key)
        told = say.plain(value).replace("_", " ")
        if name and not isinstance(value, list):
            told = f"{told} {name}"
        if key in before:
            low, until = f"{say.digits(before[key], 2)} {name}", say.plain(until_s)
            told = say("text.before_fall", before=low, until=until, whole=told)
        rows.append((say.strings.get(f"label.{key}", words), told))
    return rows
