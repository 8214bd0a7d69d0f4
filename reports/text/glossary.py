"""What a record's keys mean, in the words of a page; keys not named here are shown as they stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Final

from harness.model.finding import info
from harness.records.base import Table
from harness.records.scores import AfterHorizon, Scores
from reports.messages import ENGLISH
from reports.messages.numbers import digits, label, plain, split_unit

SCORE_WORDS: Final[Mapping[str, tuple[str, str]]] = {
    "together_until_s": ("stay together until [s]", "how long the two rotations stay within the tolerance below"),
    "together_tolerance_rad": ("within [rad]", "the tolerance of “together”"),
    "horizon_s": ("comparable until [s]", "the error of both is bounded and the motion predictable up to there"),
    "compared_until_s": ("compared instant by instant until [s]", "the same, or the end of the shorter run"),
    "rms_theta_rad": ("root mean square difference [rad]", "over the time compared"),
    "largest_difference_rad": ("largest difference [rad]", "over the time compared"),
    "peak_theta_a_rad": ("largest rotation of the first [rad]", "over the time compared"),
    "peak_theta_b_rad": ("largest rotation of the second [rad]", "over the time compared"),
    "peak_ratio": ("ratio of the largest rotations", "first over second"),
    "peak_time_difference_s": ("their times apart by [s]", "first less second"),
    "uplift_time_differences_s": ("uplifts apart by [s]", "of the uplifts that both models have"),
    "impact_times_a_s": ("impacts of both, at [s]", "times of the first model's impacts that the second has too"),
    "impact_time_differences_s": ("impacts apart by [s]", "first less second"),
    "impacts_alone_a": ("impacts that only the first has", ""),
    "impacts_alone_b": ("impacts that only the second has", ""),
    "uplifts_alone_a": ("uplifts that only the first has", ""),
    "uplifts_alone_b": ("uplifts that only the second has", ""),
    "impact_energy_lost_a_j": ("energy lost per impact, first [J]", "rocking energy of the planar motion"),
    "impact_energy_lost_b_j": ("energy lost per impact, second [J]", "rocking energy of the planar motion"),
    "impact_energy_share_lost_a": ("energy lost per impact, first (share)", "share of the rocking energy"),
    "impact_energy_share_lost_b": ("energy lost per impact, second (share)", "share of the rocking energy"),
    "rms_slip_m": ("root mean square difference of the slip [m]", "of the pedestal on the floor"),
    "residual_slip_difference_m": ("remaining slips apart by [m]", "at the common end"),
    "residual_theta_difference_rad": ("remaining rotations apart by [rad]", "at the common end"),
    "magnitude": ("magnitude error", "Sprague and Geers: 0 is equal"),
    "phase": ("phase error", "Sprague and Geers: 0 is equal"),
    "combined": ("combined error", "Sprague and Geers: root of the sum of both squares"),
    "no_return_time_difference_s": ("times of no return apart by [s]", "where both overturn"),
    "coverage": ("share of the time compared", "time compared over the longer run"),
    "outcome_agrees": ("same outcome", "falls to different sides are one outcome"),
    "side_agrees": ("fall to the same side", "where both overturn"),
    "after_horizon": ("beyond what is bounded or predictable", "where only distributions compare"),
}
"""Words of each score and what it means, in the order of the table."""
LISTED: Final = 6
"""Items of a list that fit on a terminal's line."""
SCORES_LEFT_OUT: Final = frozenset(
    {
        *("a", "b", "outcome_a", "outcome_b", "verdict", "verdict_sentence", "compared_from_s"),
        *("numerical_uncertainty", "evidence", "iso", "findings"),
    }
)
"""Keys whose content stands elsewhere on the page, or in the record alone."""

VALIDITY_WORDS: Final[Mapping[str, str]] = {
    "peak_over_slenderness": "largest rotation over the balance point's",
    "statue_friction_needed": "friction that the statue's pivot needed",
    "statue_friction_needed_at_impact": "the same at impacts",
    "statue_normal_least_n": "least force of the statue on its support",
    "floor_normal_least_n": "least force on the floor",
    "left_domain_s": "left the model's domain at",
    "left_domain_by": "left the model's domain by",
    "pedestal_tipping_margin_m": "pedestal's least margin against tipping",
    "pedestal_tipping_margin_at_impact_m": "the same at impacts",
    "energy_gained_j": "energy gained",
    "lost_in_impacts_j": "energy lost in impacts",
    "energy_lost_j": "energy lost",
    "impact_ratios": "angular velocity after each impact over before",
    "statue_slip_m": "slip of the statue on its support",
    "statue_flight_m": "height of the statue's flight",
    "penetration_m": "deepest penetration of contacts",
    "pedestal_tilt_rad": "tilt of the pedestal",
    "out_of_plane_rad": "rotation out of the rocking plane",
    "yaw_rad": "turn about the vertical",
    "statue_across_m": "movement across the rocking plane",
    "rest_lean_rad": "lean at rest on the scanned base",
    "touching_vertices": "vertices of the base that can touch",
    "plain_from_s": "events first left to whole steps at",
    "plain_for_s": "time in which events were left to whole steps",
    "plain_because": "events were left to whole steps because",
    "full_shape_from_s": "whole shape in contact from",
    "full_shape": "whole shape in contact",
}


def score_rows(scores: Mapping[str, Scores]) -> list[tuple[str, str, list[str]]]:
    """The table of scores: words, meaning, one cell per pair; each with its numerical uncertainty where it is stated."""
    known = dict.fromkeys([*SCORE_WORDS, *(each.name for each in fields(Scores))])
    rows = []
    for key in known:
        if key in SCORES_LEFT_OUT:
            continue
        values = [getattr(item, key) for item in scores.values()]
        if all(value is None or value == [] for value in values):
            continue
        words, meaning = SCORE_WORDS.get(key, (label(key), ""))
        cells = [_score(item, key) for item in scores.values()]
        if any(cells):
            rows.append((words, meaning, cells))
    return rows


def scores_text(pair: str, scores: Scores) -> str:
    """One pair's scores as lines for a terminal: the verdict and what is to be said beside it, a table in words."""
    lines = [f"{pair.replace('_vs_', ' against ')}:", *(f"  {ENGLISH.say(each)}" for each in scores.findings)]
    rows = [(words, _short(cells[0])) for words, _, cells in score_rows({pair: scores})]
    if scores.iso is not None:
        rows.append(("rating by ISO/TS 18571 (1 is perfect)", digits(scores.iso.overall, 4)))
    width = max((len(words) for words, _ in rows), default=0)
    return "\n".join([*lines, *(f"  {words:{width}}  {cell}" for words, cell in rows)])


def _short(cell: str) -> str:
    """A list too long for a line is counted."""
    count = cell.count(", ") + 1
    return cell if count <= LISTED else f"{count} of them (see --json)"


def _score(scores: Scores, key: str) -> str:
    value, uncertainty = getattr(scores, key), scores.numerical_uncertainty.get(key)
    if isinstance(value, AfterHorizon):
        return ENGLISH.say(info("after_horizon", **after_horizon_values(value)))
    text = plain(value)
    return text if uncertainty is None or value is None else f"{text} ± {digits(float(uncertainty), 2)}"


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


def validity_rows(validity: Table, before: Mapping[str, float], until_s: float | None) -> Sequence[tuple[str, str]]:
    """The limits met in one run: words and value with unit; what did not happen is left out.

    `before` holds values until the outcome was decided, at `until_s`, which are told beside those of the whole run.
    """
    rows = []
    for key, value in validity.items():
        if value is None or value in ("", []):
            continue
        words, name = split_unit(key)
        shown = plain(value).replace("_", " ")
        if name and not isinstance(value, list):
            shown = f"{shown} {name}"
        if key in before:
            shown = f"{digits(before[key], 2)} {name} until {plain(until_s)} s; with the fall {shown}"
        rows.append((VALIDITY_WORDS.get(key, words), shown))
    return rows
