"""What a run says beside its findings: verdict and colour, how far it moves, scores of pairs, limits met, what was left out; a
study's rows in words.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, Literal

import numpy as np

from harness.model import Finding, History, Outcome, Run, RunRow, grouped, info, number
from harness.records.assess import Assessment
from harness.records.run import SLIDES_M, UNKNOWN, RunRecord, left_early, peak_slip_m
from harness.records.scores import AfterHorizon, Scores
from reports.blocks import Cell, Chip, Verdict, code, verdict
from reports.drawing.kinematics import poses, room_m, sampled, top_shift_m
from reports.messages import ENGLISH, Language
from reports.source import RunSource

# The outcomes of runs as signs, words and colours.

SIGNS: Final = {
    "stands": "●", "overturned_left": "◀", "overturned_right": "▶", "overturned_front": "▼", "overturned_back": "▲",
    "touches_wall": "▌", "left_pedestal": "⇲", "lift_off": "↥", "friction_paradox": "∅", "undecided": "?",
}  # fmt: skip
"""The sign of each outcome: told apart without colour."""
FAMILIES: Final = {"stands": "stands", "touches_wall": "wall", "overturns": "overturns", "failed": "failed"}


def end_key(outcome: Outcome) -> str:
    """The key of an outcome's words: of every fall, and of every failure of a model, the same."""
    if outcome.overturned:
        return "overturns"
    return "failed" if outcome.failed else str(outcome)


def family(outcome: Outcome) -> str:
    """The outcome's class for colours: stands, overturns, wall, other, failed."""
    return FAMILIES.get(end_key(outcome), "other")


def doubted(run: RunRow) -> bool:
    """Whether a run has an end that is told outside its model's domain."""
    return left_early(run) and run.outcome not in UNKNOWN


def told_family(run: RunRow) -> str:
    """The class of what a run tells of the statue: nothing outside its model's domain."""
    return "other" if doubted(run) else family(run.outcome)


def symbol(outcome: str, say: Language) -> tuple[str, str]:
    """Sign and words of an outcome, of any failure the same."""
    return (SIGNS[outcome], say(f"short.{outcome}")) if outcome in SIGNS else ("✕", say("text.map_failed"))


def told_symbol(run: RunRow, say: Language) -> tuple[str, str]:
    """Sign and words of a run's outcome, in brackets outside its model's domain."""
    sign, words = symbol(run.outcome, say)
    return (f"({sign})", f"({words})") if doubted(run) else (sign, words)


def symbols(say: Language) -> list[tuple[str, str]]:
    """Every sign with its words."""
    return [*(symbol(each, say) for each in (*SIGNS, "failed")), ("·", say("text.not_sent"))]


SAFE: Final = 0.05
"""Green only where the probability of falling is at most this, and"""
SAFE_HIGH: Final = 0.10
"""its interval stays below this."""
LIKELY: Final = 0.5
"""From here on a fall is the likelier end."""
Tone = Literal["agree", "differ", "failed"]
SEVERITY: Final[tuple[str, ...]] = ("agree", "differ", "failed")


def tone_of_outcomes(families: Iterable[str]) -> Tone:
    """The colour of outcomes by their families (`family`): `agree` only where every answer is that it stands."""
    ends = set(families)
    return "agree" if ends == {"stands"} else "differ" if ends & {"stands", "wall"} else "failed"


def tone_of_study(families: Iterable[str]) -> Tone:
    """The colour of a study's outcomes: without a probability of a fall never green, however many situations are stood."""
    tone = tone_of_outcomes(families)
    return "differ" if tone == "agree" else tone


def tone_of_probability(item: Assessment) -> Tone:
    """The colour of a probability: `agree` only where a fall is improbable, and its interval says so too."""
    if item.probability_overturned <= SAFE and item.high < SAFE_HIGH:
        return "agree"
    return "failed" if item.probability_overturned >= LIKELY else "differ"


def tone_of_answers(answers: Mapping[str, Assessment], colour: Tone = "agree") -> Tone:
    """The worst colour of several models' probabilities and a run's own; no green where all leave a part of the shaking out."""
    known = any(not item.plane_only for item in answers.values())
    told = map(tone_of_probability, answers.values())
    return max([colour, *told, "agree" if known else "differ"], key=SEVERITY.index)


STUCK_M: Final = 1e-5
"""Slips of a pedestal, and ways of a top, below this are the give of a contact engine at rest."""


def run_verdict(source: RunSource, chips: Sequence[Chip] = (), say: Language = ENGLISH) -> Verdict:
    """The record's answer as a headline with points, coloured by what happens and by how probable a fall is."""
    moved = [say.say(each) for each in (*_reach(source), *_slip(source))]
    return verdict(source.record, tone(source), moved, chips)


def tone(source: RunSource) -> str:
    """The colour of a run: one run is one draw: a shaking that it stands is no reason for green, nor are models that differ."""
    colour: Tone = tone_of_outcomes(family(run.outcome) for run in source.answered.values())
    if colour == "agree" and code(source.record) not in ("agree", "agree_until", "one_model"):
        colour = "differ"
    if source.record.assessment:
        return tone_of_answers(source.record.assessment, colour)
    return "differ" if colour == "agree" and source.record.motion.accel_m_s2 else colour


def _reach(source: RunSource) -> list[Finding]:
    """How far the top moves where the statue stands, and what room is left to the wall."""
    scene, found = source.scene, []
    moves = {name: poses(scene, sampled(item)) for name, item in source.histories.items()}
    tops = {
        name: float(np.hypot(*top_shift_m(scene, pose).T).max())
        for name, pose in moves.items()
        if source.runs[name].outcome == Outcome.STANDS
    }
    if tops and max(tops.values()) > STUCK_M:
        name = max(tops, key=lambda item: tops[item])
        found.append(info("top_moves", top_m=tops[name], model=name))
    wall, struck = scene.wall, any(run.outcome is Outcome.TOUCHES_WALL for run in source.runs.values())
    if wall is not None and moves and not struck:
        left = min(room_m(scene, pose) for pose in moves.values())
        found.append(info("room_to_wall", side=wall.side, left_m=max(left, 0.0)))
    return found


def _slip(source: RunSource) -> list[Finding]:
    """How far the pedestal slides, and whether it tips."""
    slips, tilts = pedestal_moves(source)
    if not slips:
        return []
    ends = [min(slips.values()), max(slips.values())]
    slides = info("pedestal_slips", slip_m=ends) if ends[1] >= STUCK_M else None
    most = max(tilts, key=lambda name: tilts[name])
    tips = [info("pedestal_tilts", tilt_rad=tilts[most], model=most)] if tilts[most] > TIPS_RAD else []
    return [info("pedestal_still") if slides is None else slides, *tips]


def pedestal_moves(source: RunSource) -> tuple[dict[str, float], dict[str, float]]:
    """How far the pedestal slides, m, and tips, rad, by each model that answered; nothing without a pedestal."""
    answered = {} if source.scene.pedestal is None else source.answered
    tilts = {name: tilt_rad(run, source.histories.get(name)) for name, run in answered.items()}
    return {name: peak_slip_m(run) for name, run in answered.items()}, tilts


def prediction_s(source: RunSource) -> float | None:
    """The measured horizon of prediction: from then on nobody can follow the motion; None where none was measured."""
    return min((each.intrinsic_s for each in (source.record.horizons or {}).values()), default=None)


def horizon_s(source: RunSource) -> float | None:
    """Up to when every model's history is reliable: the least `reliable_until_s`; None when no model states one."""
    return min((run.bounded_until_s for run in source.runs.values() if run.bounded_until_s < run.end_s), default=None)


def score_rows(scores: Mapping[str, Scores], say: Language = ENGLISH) -> list[tuple[Cell, *tuple[str, ...]]]:
    """The table of scores, in the order of the catalogue's meanings: words with their meaning, one cell per pair.

    Each has its numerical uncertainty where it is stated.
    """
    keys = [name.removeprefix("meaning.") for name in say.strings if name.startswith("meaning.")]
    return [
        (Cell(say.label(key), tip=say(f"meaning.{key}")), *(_score(item, key, say) for item in scores.values()))
        for key in keys
        if any(getattr(item, key) not in (None, []) for item in scores.values())
    ]


def scores_text(pair: str, scores: Scores) -> str:
    """One pair's scores as lines for a terminal: the verdict and what is to be said beside it, a table in words."""
    lines = [f"{pair.replace('_vs_', ' against ')}:", *(f"  {ENGLISH.say(each)}" for each in scores.findings)]
    rows = [(name.text, cells[0]) for name, *cells in score_rows({pair: scores})]
    if scores.iso is not None:
        rows.append((ENGLISH.label("iso"), ENGLISH.digits(scores.iso.overall, 4)))
    width = max((len(words) for words, _ in rows), default=0)
    return "\n".join([*lines, *(f"  {words:{width}}  {cell}" for words, cell in rows)])


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


FOLLOWED: Final[Mapping[str, str]] = {
    "yaw_rad": "yaw_rad",
    "out_of_plane_rad": "out_of_plane_rad",
    "statue_across_m": "statue_y_m",
    "statue_slip_m": "statue_slip_m",
    "pedestal_tilt_rad": "pedestal_tilt_rad",
}
"""Limits that a history follows, with its column: there the part before the outcome was decided can be told."""

WITH_FALL: Final = (
    "statue_friction_needed",
    "statue_normal_least_n",
    "floor_normal_least_n",
    "pedestal_tipping_margin_m",
)
"""Limits that no history follows: of one that overturns they are of the fall too, and told so."""

TIPS_RAD: Final = 1e-3
"""A pedestal that tips by more is said to."""


def limits(run: Run, history: History | None, say: Language = ENGLISH) -> dict[str, object]:
    """A run's limits by key, and what was written to its bodies; of one that overturns what they were until its point of no
    return too."""
    before, until_s = before_fall(run, history), run.no_return_time_s
    shown: dict[str, object] = dict(run.validity)
    for key in [key for key in shown if shown[key] is not None and until_s is not None]:
        whole = say.plain(shown[key])
        if key in before:
            low = say.digits(before[key], 2)
            shown[key] = say("text.before_fall", before=low, until=say.plain(until_s), whole=whole)
        elif key in WITH_FALL:
            shown[key] = say("text.with_fall", whole=whole)
    return shown | {"interventions": interventions_text(run, say)}


def interventions_text(run: Run, say: Language = ENGLISH) -> str:
    """What was written to the engine's bodies on the way, in one line; nothing for an unmodified engine."""
    written, lost = run.interventions, run.validity.get("lost_in_impacts_j")
    if not written:
        return ""
    counts = {kind: item.count or item.steps_again for kind, item in written.items()}
    kinds = say.listed(f"{say.strings.get(f'wrote.{kind}', kind)}: {count}" for kind, count in counts.items())
    parts = ("moved_m", "velocity_m_s", "rate_rad_s", "given_j", "taken_j")
    sums = {part: say.digits(sum(vars(item)[part] for item in written.values()), 2) for part in parts}
    beside = say("text.impacts_lost", lost=say.digits(lost, 2)) if isinstance(lost, float) else ""
    again = sum(item.steps_again for item in written.values())
    return say("text.interventions", kinds=kinds, again=again, beside=beside, **sums)


def before_fall(run: Run, history: History | None) -> dict[str, float]:
    """Largest values, until the balance point is passed for good, of the limits that a fallen statue's history follows."""
    until = run.no_return_time_s
    if history is None or until is None:
        return {}
    upright = history.t_s <= until
    # The history of a slip on the support is of the one along the plane.
    aside = {"statue_slip_m"} if number(run.validity, "slip_across_m", 0.0) > SLIDES_M else set()
    known = {
        key: np.asarray(history.extra[column])
        for key, column in FOLLOWED.items()
        if key in run.validity and key not in aside and column in history.extra and upright.any()
    }
    starts = {key: values[0] if key == "yaw_rad" else 0.0 for key, values in known.items()}
    return {key: float(np.max(np.abs(values[upright] - starts[key]))) for key, values in known.items()}


def tilt_rad(run: Run, history: History | None) -> float:
    """The pedestal's largest tilt, of a statue that falls until it passes its balance point; 0 for a model that has none."""
    until, whole = before_fall(run, history), run.validity.get("pedestal_tilt_rad")
    return until.get("pedestal_tilt_rad", whole if isinstance(whole, float) else 0.0)


def plan_lines(record: RunRecord, say: Language = ENGLISH) -> list[str]:
    """What was left out and what was computed, for which engines (those of one reason together), and why; what each saved."""
    together = grouped(
        ((step.applies, say(f"skip.{step.skip}"), say.say(step.reason)), step.engine) for step in record.plan
    )
    lines = [
        say("text.plan_left_out" if applies else "text.plan_computed", what=what, reason=reason,
            engines="" if "*" in engines else f" ({say.listed(engines)})")
        for (applies, what, reason), engines in together.items()
    ]  # fmt: skip
    saved = {(name, skip): time_s for name, run in record.runs.items() for skip, time_s in run.skipped.items()}
    return lines + [
        f"{name}: {say(f'skip.{skip}')}" + ("" if time_s is None else f" ({say.value(time_s, 's')})")
        for (name, skip), time_s in saved.items()
    ]
