"""A record as the pages read it; nothing is computed anew.

A run with its histories and mesh, when anything moves, what it says beside its findings; a study's rows by condition and model.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Final, Literal, Self

import numpy as np

from harness.input.history_file import read_history
from harness.model import (
    Finding,
    History,
    InputError,
    Mistake,
    Outcome,
    Run,
    RunRow,
    grouped,
    history_file,
    info,
    number,
    refuse,
)
from harness.records.assess import Assessment
from harness.records.base import RECORD, REWRITE, Record, as_written, read_result
from harness.records.run import SLIDES_M, UNKNOWN, RunRecord, has_answer, known_until_s, left_early, peak_slip_m
from harness.records.scene import SceneRecord
from harness.records.scores import AfterHorizon, Scores
from harness.records.study import CaseRun, StudyRow, Value
from reports.blocks import Cell, Chip, Verdict, code, verdict
from reports.drawing.kinematics import poses, room_m, sampled, top_shift_m
from reports.messages import ENGLISH, Language

MOVED_SHARE: Final = 0.01
"""A rotation of this share of the balance point's shows on a page."""
MOVED_M: Final = 1e-4
"""A slip that shows on a page."""
PEAKS: Final = ("peak_lean_rad", "peak_lean_share", "peak_over_slenderness", "pedestal_tilt_share")
"""What a run says of its largest lean beside its history."""
BESIDE: Final = 0.05
LEAST_BESIDE_S: Final = 0.25
"""Room before and after an event: a share of its length, and at least the time in which an eye finds its place."""


@dataclass(frozen=True, eq=False)
class RunSource:
    """The record of one run with the histories that it names; `mesh` is the statue's mesh file, None without one."""

    folder: Path
    record: RunRecord
    histories: Mapping[str, History]
    mesh: Path | None

    @property
    def scene(self) -> SceneRecord:
        """The resolved scene."""
        return self.record.scene

    @property
    def runs(self) -> Mapping[str, Run]:
        """All engines' answers by name."""
        return self.record.runs

    @property
    def answered(self) -> dict[str, Run]:
        """The answers of the models that say something of the statue."""
        return {name: run for name, run in self.runs.items() if has_answer(run)}

    @property
    def standing(self) -> list[str]:
        """The models that answered with a history and in which the statue stands."""
        answered = self.answered
        return [name for name in self.histories if name in answered and answered[name].outcome is Outcome.STANDS]

    @property
    def within_domain(self) -> Self:
        """The same, of what models tell within their domain where one stays in it: histories of those in which it stands, the
        pedestal's slips of all."""
        runs, histories = dict(self.runs), dict(self.histories)
        known = known_until_s({name: run for name, run in self.answered.items() if name in histories})
        for name, until_s in known.items():
            if until_s < runs[name].end_s:
                runs[name] = replace(runs[name], peak_slip_m=float(np.abs(histories[name].until(until_s).slip_m).max()))
        for name, until_s in known_until_s({name: self.runs[name] for name in self.standing}).items():
            histories[name] = histories[name].until(until_s)
            if until_s < runs[name].peaks_until_s:
                told = {key: value for key, value in runs[name].validity.items() if key not in PEAKS}
                runs[name] = replace(runs[name], validity=told)
        return replace(self, record=replace(self.record, runs=runs), histories=histories)


def run_source(folder: Path) -> RunSource:
    """The record of a run and its histories; raises `InputError` for a damaged folder, or one of another kind."""
    record = read_result(folder)
    if not isinstance(record, RunRecord):
        raise InputError(Mistake(str(folder / RECORD), "kind", "run", repr(record.kind)))
    return source_of(folder, record)


@lru_cache(maxsize=1)
def source_of(folder: Path, record: RunRecord) -> RunSource:
    """The record of a run with what lies beside it, read once for all pages; raises `InputError` where that is lost."""
    paths = {name: folder / history_file(name) for name in record.histories}
    # Of a statue of numbers none was written: a mesh that lies there is another's.
    mesh = None if record.scene.statue.mesh is None else folder / "statue.glb"
    check_files([*paths.values(), *([] if mesh is None else [mesh])], record)
    # What has its checksum is as it was written; of older records it is read as another's file is.
    listed = record.files or {}
    histories = {
        name: History.read_csv(path) if path.name in listed else read_history(path) for name, path in paths.items()
    }
    return RunSource(folder, record, histories, mesh)


def check_files(paths: Iterable[Path], record: Record) -> None:
    """Raise `InputError` for files of a result that are lost or were changed."""
    found = {
        path: "another content" if path.is_file() else "none there"
        for path in paths
        if not (path.is_file() and as_written(path, record))
    }
    wanted = "the file that result.json names"
    refuse([Mistake(str(path), "", wanted, got, REWRITE) for path, got in found.items()])


def event_s(histories: Iterable[History], level_rad: float, end_s: float) -> tuple[float, float]:
    """From shortly before anything moves to shortly after it has come to its last place: what a chart opens on, s.

    A rotation of `level_rad` counts as moving, a slip of `MOVED_M`; the whole of a run in which nothing moves.
    """
    moved = [
        (history.t_s, *(np.flatnonzero(np.abs(values - values[k]) > least) for k in (0, -1)))
        for history in histories
        for values, least in ((history.theta_rad, level_rad), (history.slip_m, MOVED_M))
    ]
    events = [(float(t_s[gone[0]]), float(t_s[left[-1]])) for t_s, gone, left in moved if len(gone)]
    if not events:
        return 0.0, end_s
    begin, end = min(start for start, _ in events), max(end for _, end in events)
    margin = max(BESIDE * (end - begin), LEAST_BESIDE_S)
    return max(0.0, begin - margin), min(end_s, end + margin)


def run_event_s(source: RunSource) -> tuple[float, float]:
    """The event of a run."""
    statue = source.scene.statue
    level_rad = MOVED_SHARE * min(statue.slenderness_left_rad, statue.slenderness_right_rad)
    return event_s(source.histories.values(), level_rad, source.scene.duration_s)


# A study's rows arranged for tables and pictures: conditions down, models across.


LEAST: Final = 3
"""Fewer values than this along an axis make no map and no curve: the table shows them better."""
ENGINES: Final = ("analytic", "pymunk", "pybullet")
"""Those that come first within a variant."""


@dataclass(frozen=True)
class Condition:
    """One combination of what the study varies, with every model's row of it (the variants' own keys aside)."""

    varied: Mapping[str, Value]
    answers: Mapping[str, StudyRow] = field(default_factory=dict)

    def run(self, model: str) -> CaseRun | None:
        """A model's run; None where it was not sent."""
        row = self.answers.get(model)
        return None if row is None else row.run

    def number(self, key: str) -> float:
        """The value of a key that varies among numbers."""
        return float(self.varied[key])


@dataclass(frozen=True)
class Answers:
    """What the models of a study answer under each condition."""

    models: Sequence[str]
    cases: Sequence[Condition]
    asked: Sequence[str] = ()
    """The keys of the study's own axes; what is scattered stands in the conditions alone."""

    @classmethod
    def of(cls, rows: Iterable[StudyRow], asked: Iterable[str] = ()) -> Self:
        """The conditions in the study's order; variants as the study has them, within each the analytic model first."""
        ordered = sorted(rows, key=lambda row: int(row.number))
        varied = [{key: value for key, value in row.varied.items() if key != "variant"} for row in ordered]
        by_values = grouped((tuple(each.values()), (each, row)) for each, row in zip(varied, ordered, strict=True))
        cases = [Condition(group[0][0], {row.model: row for _, row in group}) for group in by_values.values()]
        models = list(dict.fromkeys(row.model for row in ordered))
        variants = list(dict.fromkeys(model.partition(" (")[2] for model in models))

        def place(model: str) -> tuple[int, int, str]:
            engine, _, variant = model.partition(" (")
            return variants.index(variant), (*ENGINES, engine).index(engine), engine

        return cls(sorted(models, key=place), cases, [*asked])

    @cached_property
    def keys(self) -> list[str]:
        """All keys of the conditions."""
        return list(self.cases[0].varied) if self.cases else []

    @cached_property
    def varying(self) -> list[str]:
        """The keys that take more than one value."""
        return [key for key in self.keys if len({repr(item.varied[key]) for item in self.cases}) > 1]

    @cached_property
    def axes(self) -> list[str]:
        """The study's own axes along which something varies."""
        return [key for key in self.asked if key in self.varying]

    def runs(self, model: str) -> list[tuple[Condition, CaseRun]]:
        """The conditions that a model answered, each with its run."""
        return [(item, run) for item in self.cases if (run := item.run(model)) is not None]

    def numbers(self, key: str) -> list[float]:
        """The values that a key takes, in their order; none where one of them is not a number."""
        values = {item.varied[key] for item in self.cases}
        known = [value for value in values if isinstance(value, (int, float)) and not isinstance(value, bool)]
        return sorted(map(float, known)) if len(known) == len(values) else []

    @cached_property
    def plane(self) -> tuple[str, str] | None:
        """The axes of a map: the two of numbers with most values, when both have enough of them (an amplitude is drawn
        upwards)."""
        sizes = sorted(((len(self.numbers(key)), key) for key in self.axes), reverse=True)
        first, second = ([key for size, key in sizes if size >= LEAST] + ["", ""])[:2]
        if not second:
            return None
        return (second, first) if "amplitude" in first else (first, second)

    @cached_property
    def single_plane(self) -> tuple[str, str] | None:
        """The axes of a map where each of its places stands for one condition."""
        places = {tuple(item.varied[key] for key in self.plane or ()) for item in self.cases}
        return self.plane if len(places) == len(self.cases) else None

    def apart(self, kept: Sequence[str], say: Language) -> list[tuple[str, Self]]:
        """The conditions by all axes but the `kept`, with what these are in words."""
        keys = [key for key in self.axes if key not in kept]
        groups = grouped((repr([item.varied[key] for key in keys]), item) for item in self.cases)
        return [
            (
                "".join(f" · {say.label(key)} {say.value(members[0].varied[key], 'plain')}" for key in keys),
                replace(self, cases=members),
            )
            for members in groups.values()
        ]


# The outcomes of runs as signs, words and colours.

SIGNS: Final = {
    "stands": "●", "overturned_left": "◀", "overturned_right": "▶", "overturned_front": "▼", "overturned_back": "▲",
    "touches_wall": "▌", "left_pedestal": "⇲", "lift_off": "↥", "friction_paradox": "∅", "undecided": "?",
}  # fmt: skip
"""The sign of each outcome: told apart without colour."""
FAMILIES: Final = {"stands": "stands", "touches_wall": "wall", "overturns": "overturns", "failed": "failed"}


def end_key(outcome: Outcome) -> str:
    """The key of an outcome's words: of every fall, and of every failure of a model, the same."""
    return "overturns" if outcome.overturned else "failed" if outcome.failed else str(outcome)


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


# What a run says beside its findings: verdict and colour, how far it moves, scores of pairs, limits met, what was left out.

STUCK_M: Final = 1e-5
"""Slips of a pedestal, and ways of a top, below this are the give of a contact engine at rest."""


def run_verdict(source: RunSource, chips: Sequence[Chip] = (), say: Language = ENGLISH) -> Verdict:
    """The record's answer as a headline with points, coloured by what happens and by how probable a fall is."""
    return verdict(source.record, tone(source), [say.say(each) for each in (*_reach(source), *_slip(source))], chips)


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
