"""A target accuracy instead of a time step: climb an engine's refinement levels until its own runs agree.

The error of a run is taken from the spread between it and a coarser run of the same engine with other settings (twice the
step, other order of bodies, fewer iterations), never from another model. Where errors fall at least in proportion to the step,
the finer run's is at most the spread over (the steps' ratio - 1); `SAFETY` covers that errors of contact fall
irregularly. Two runs may agree by chance where small differences grow: so a third one, of the coarser settings under a slightly
stronger motion, shows how they do (`sensitivity`). How often statements hold: docs/engines.md.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from harness import engines
from harness.accuracy.horizon import PERTURBED_SHARE, amplified, last_s, outgrown_s, several_slides_s, unseen_tipping_s
from harness.engines.base import VERIFICATION_STEP_SHARE, Engine, EngineFailure, LayerFault, Settings, own_failures
from harness.model import Array, Finding, Outcome, Run, RunOptions, Scene, caution, info, must_be_scene, number, require

if TYPE_CHECKING:
    from harness.input.tables import Overrides


# How far two runs of one engine are apart in rotation and slip, and what that says of the finer one.


SAFETY: Final = 3.0
"""Stated uncertainty over the error that a spread shows: what the grid convergence index takes for two grids (Roache, 1994);
docs/measured/random_scenes.md says how often it was enough."""
LEAST_RATIO: Final = 1.5
"""Two steps that are nearer to each other than this say no more of the error than two that are so far apart."""
PLAIN_ORDER: Final = 0.5
"""Order at which errors are taken to fall where events are not located: on tipping pedestals that of order 1 was missed by one
statement in nine, most by less than a factor of 2.5, which is what this order makes of two steps of the ratio 2.2."""
CLEAR: Final = 4.0
"""One comparison is enough for any engine where two runs are nearer by this factor than they must be."""
LEAST_COMPARED: Final = 200
"""Instants at which two histories are compared at least, however coarse their output."""


@dataclass(frozen=True)
class Error:
    """Error of a run, or a target for it: of the rotation, rad, and of the pedestal's slip, m."""

    rotation_rad: float
    slip_m: float

    def times(self, factor: float) -> Error:
        """Both multiplied by a factor."""
        return Error(factor * self.rotation_rad, factor * self.slip_m)

    def share_of(self, target: Error) -> float:
        """The larger of the two, each as a share of its target."""
        return max(self.rotation_rad / target.rotation_rad, self.slip_m / target.slip_m)

    def or_more(self, *others: Error) -> Error:
        """The largest rotation and the largest slip among this and others."""
        items = (self, *others)
        return Error(max(item.rotation_rad for item in items), max(item.slip_m for item in items))


NONE: Final = Error(0.0, 0.0)


def target_of(scene: Scene, accuracy_rad: float) -> Error:
    """The target of both for a target of the rotation, rad: the slip is asked to the accuracy times the centroid's height h.

    An error of the rotation moves the centroid by h times it, an error of the slip by itself: so neither counts for more. Without
    friction on the floor, M du + m h dθ = 0, an error of the rotation makes one of the slip, of at most h times it.
    """
    return Error(accuracy_rad, accuracy_rad * scene.statue.centroid_height_m)


@dataclass(frozen=True)
class Spread:
    """Difference of two runs: largest up to `until_s`, the last instant before it says that the target is missed.

    Where events are not located, differences count `plain_share` times.
    `clear_s` is the same for the target over `CLEAR`.
    `coarse_dt_s`, `fine_dt_s`: their steps. `apart`: largest difference to the end, infinite where the ends differ.
    """

    largest: Error
    until_s: float
    whole: bool
    coarse_dt_s: float
    fine_dt_s: float
    apart: Error = Error(math.inf, math.inf)
    clear_s: float = 0.0

    @property
    def stated(self) -> Error:
        """Uncertainty of the finer run that this difference shows."""
        return self.largest.times(factor(self.coarse_dt_s, self.fine_dt_s))

    @property
    def stated_to_the_end(self) -> Error:
        """The same from the largest difference to the end, though the target is missed before."""
        return self.apart.times(factor(self.coarse_dt_s, self.fine_dt_s))


def factor(coarse_dt_s: float, fine_dt_s: float) -> float:
    """Stated uncertainty of a run over its largest difference from a run with a longer step."""
    return SAFETY / (max(coarse_dt_s / fine_dt_s, LEAST_RATIO) - 1.0)


def plain_from_s(run: Run) -> float:
    """When a run left what its events are located for, infinite: it never did."""
    return number(run.validity, "plain_from_s", math.inf)


def plain_share(coarse_dt_s: float, fine_dt_s: float) -> float:
    """By how much more two runs' difference counts where it falls with `PLAIN_ORDER` only."""
    ratio = max(coarse_dt_s / fine_dt_s, LEAST_RATIO)
    return float((ratio - 1.0) / (ratio**PLAIN_ORDER - 1.0))


def spread(coarse: Run, fine: Run, target: Error, limit: Error | None = None) -> Spread:
    """How far two runs are apart, and until when the finer one is by that within `target`.

    `limit`: the difference that just meets the target, where the two differ by more than their steps.
    Raises `ValueError` when a run has no history.
    """
    if coarse.history is None or fine.history is None:
        raise ValueError("both runs must have kept their histories")
    end_s = min(coarse.end_s, fine.end_s)
    count = max(LEAST_COMPARED, min(coarse.history.t_s.size, fine.history.t_s.size))
    times = np.linspace(0.0, end_s, count, dtype=np.float64)
    turned = np.abs(coarse.history.at(times) - fine.history.at(times))
    slid = np.abs(coarse.history.slip_at(times) - fine.history.slip_at(times))
    # An overturn that only one run sees, or at another time, is a difference once the other has ended.
    same_end = abs(coarse.end_s - fine.end_s) <= 2.0 * float(np.max(np.diff(fine.history.t_s), initial=0.0))
    steps = number(coarse.settings, "dt_s"), number(fine.settings, "dt_s")
    plain = np.where(times > min(plain_from_s(coarse), plain_from_s(fine)), plain_share(*steps), 1.0)
    turned, slid = plain * turned, plain * slid
    limit = limit or target.times(1.0 / factor(*steps))
    share = np.maximum(turned / limit.rotation_rad, slid / limit.slip_m)
    # How many instants come before the first at which they are further apart than that.
    met, clear = (int(np.argmax(np.append(share > most, True))) for most in (1.0, 1.0 / CLEAR))
    whole = met == share.size and (same_end or coarse.outcome == fine.outcome)
    within = share.size if whole else min(met, share.size - 1)
    until_s = fine.end_s if whole else float(times[max(within - 1, 0)])
    return Spread(
        _largest(turned[:within], slid[:within]),
        until_s,
        whole,
        *steps,
        apart=_largest(turned, slid) if whole or same_end else Error(math.inf, math.inf),
        clear_s=until_s if clear == share.size else min(float(times[max(clear - 1, 0)]), until_s),
    )


def _largest(turned_rad: Array, slid_m: Array) -> Error:
    return Error(float(np.max(turned_rad, initial=0.0)), float(np.max(slid_m, initial=0.0)))


# Whether finer steps are worth their cost: by what a climb's comparisons show.

LEAST_SPREADS: Final = 3
"""Comparisons before a climb is given up: the gain of one step to the next, which two tell, is luck where runs part at events."""
MOST_ORDER: Final = 2.0
"""Highest order that two differences are taken to show."""


def hopeless(spreads: list[Spread], end_s: float, finest_dt_s: float, target: Error) -> bool:
    """Whether no level is expected to reach `end_s`, by what all comparisons together gained: two of them tell luck.

    A small difference grows in proportion to itself, so each halving of the step gains about the same time; unless what
    parts the runs is an event whose error falls with the step.
    """
    if len(spreads) < LEAST_SPREADS or spreads[-1].whole or _falls(spreads, finest_dt_s, target):
        return False
    first, last = spreads[0], spreads[-1]
    reached_s = max(item.until_s for item in spreads)
    gained = (reached_s - first.until_s) / math.log(first.coarse_dt_s / last.coarse_dt_s)
    possible = gained * math.log(max(last.coarse_dt_s / finest_dt_s, 1.0))
    return possible < end_s - reached_s


def _falls(spreads: list[Spread], finest_dt_s: float, target: Error) -> bool:
    """Whether the largest difference of two runs falls with the step, so fast that the finest level should do."""
    known = [item for item in spreads if 0.0 < item.apart.share_of(target) < math.inf]
    if len(known) < 2:
        return False
    first, last = known[0], known[-1]
    now, then = last.stated_to_the_end.share_of(target), first.stated_to_the_end.share_of(target)
    order = math.log(then / now) / math.log(first.coarse_dt_s / last.coarse_dt_s)
    expected = now * (finest_dt_s / last.coarse_dt_s) ** min(order, MOST_ORDER)
    return order >= PLAIN_ORDER and expected <= 1.0


# How much a small change of the motion moves an engine's answer: where that is much, two runs may agree by chance. The error of
# a step acts as a slightly other motion does. A third run, under a motion stronger by as much as the step is expected to err
# by, shows what the scene makes of such an error: it does not take part in the luck of two runs that agree.

PARTED: Final = 4.0
"""Two runs that differ by this many times the target have parted for good."""


def stronger(scene: Scene, share: float) -> Scene:
    """The scene with all its motion, or without any its start, stronger by this share."""
    if not scene.base_excitation.still:
        return amplified(scene, 1.0 + share)
    start = scene.initial
    if start.pose is not None:
        pose = start.pose.faster(1.0 + share)
        return replace(scene, initial=replace(start, pose=pose))
    return replace(scene, initial=start.plus(share * start.theta_rad, share * start.theta_rate_rad_s))


START_SHARE: Final = 1.5
"""The first level may be expected to miss the target by this much: the run that is kept is twice as fine."""
COARSER: Final = 12.0
"""A target that no level is expected to meet is tried first with over so many times the finest step: at a tenth of its cost."""
CLIMB_SHARE: Final = 0.75
"""A level is worth a run when its step is shorter than all that were tried by at least this."""
LEAP: Final = 4.0
"""Factor by which the step may shrink at once, where two runs are so far apart that one halving would not do."""
ORDER: Final = 1.5
"""Order at which errors are expected to fall when that step is chosen."""
FLOOR_SHARE: Final = 1.0
"""Share of a level's expected error below which no uncertainty is stated: two runs may agree by chance."""
LEFT_AGREEMENTS: Final = 2
"""Comparisons that must hold in a row where a run leaves what its events are located for: from there plain steps err unevenly."""
LONG_STEPS: Final = 4000
"""The analytic model is asked whether errors outgrow the target where a climb takes so many steps that its answer pays."""
RESPONSES: Final = 2
"""So many times a climb goes on because a small change of the motion moves more than the target; then finer steps gain little."""


def run_to_accuracy(engine: Engine, scene: Scene, accuracy_rad: float, options: RunOptions) -> Run:
    """Compute a scene to a target accuracy of the rotation, rad, at the least cost that the engine's own spread allows.

    The slip has the target of `target_of`. The run states both uncertainties and until when they hold; where the
    target is not met for the whole run it says why. Raises `EngineFailure` when the engine cannot finish.
    """
    if engine.capabilities.certifies or not options.stated:
        return engine.simulate(scene, first_level(engine.refinement_levels(scene), accuracy_rad, 1.0)[0], options)
    climb = _Climb(engine, scene, target_of(scene, accuracy_rad), engine.refinement_levels(scene), options)
    for settings in climb.order():
        if not climb.affords(settings):
            break
        check = _Check(climb, settings.dt_s)
        asked = replace(options, history=True, stop=check, coarser_from_s=climb.unbounded_from_s(settings))
        run = engine.simulate(scene, settings, asked)
        if climb.ends_with(settings, run, check):
            break
        if climb.agreed_s is not None and climb.met(climb.response(climb.agreed_s), climb.agreed_s):
            break
    best, until_s = climb.best()
    return climb.stated(best, until_s, None if until_s is None else climb.response(until_s))


@dataclass
class _Climb:
    """The runs of one climb: `whole` were not ended early, `spreads` are of each run and the one before it.

    `agreed_s` is until when the last two agree, None where they do not or a third is needed; `answer` is what a slightly
    stronger motion changed in the last two runs that were asked for it; `not_tried_s` the step that would have taken too many.
    `outgrown`: the finest level's errors outgrow the target.
    """

    engine: Engine
    scene: Scene
    target: Error
    refinement_levels: tuple[Settings, ...]
    options: RunOptions
    whole: list[tuple[Settings, Run]] = field(default_factory=list)
    spreads: list[Spread] = field(default_factory=list)
    agreed_s: float | None = None
    answer: Spread | None = None
    answers: int = 0
    costs: list[tuple[int, float]] = field(default_factory=list)
    not_tried_s: float | None = None
    outgrown: bool = False

    def order(self) -> Iterator[Settings]:
        """Settings in the order in which they are tried: a level, its verification runs, then levels finer than these.

        How far the last two runs were apart says how much finer the next must be.
        """
        levels = self.refinement_levels
        index = first_level(levels, self.target.rotation_rad, START_SHARE)[1]
        if not self.promised:
            index = max(sum(item.dt_s > COARSER * levels[-1].dt_s for item in levels) - 1, 0)
        elif self.scene.duration_s >= LONG_STEPS * levels[second := second_level(levels, index)].dt_s:
            finest_rad = levels[-1].expected_error_rad
            self.outgrown = outgrown_s(self.scene, finest_rad, self.target.rotation_rad) < math.inf
            index = second if self.outgrown else index
        while index < len(levels):
            yield levels[index]
            finest = levels[index].dt_s
            for verification in self.engine.verification_settings(self.scene, levels[index]):
                yield verification
                finest = min(finest, verification.dt_s)
            # Two runs with one step would agree on an error that is the step's.
            finer = [i for i in range(index + 1, len(levels)) if levels[i].dt_s < CLIMB_SHARE * finest]
            wanted = finest / _factor(self.spreads, self.target)
            index = next((i for i in finer if levels[i].dt_s <= wanted), finer[-1] if finer else len(levels))

    def unbounded_from_s(self, settings: Settings) -> float:
        """From when on nothing will be stated of a run, as what its level errs by has outgrown the target."""
        if not self.outgrown:
            return math.inf
        return outgrown_s(self.scene, settings.expected_error_rad, self.target.rotation_rad)

    def affords(self, settings: Settings) -> bool:
        """Whether a run with these settings and all before it make no more steps than a climb may."""
        spent, needed = sum(steps for steps, _ in self.costs), self.scene.duration_s / settings.dt_s
        if not self.whole or spent + needed <= self.options.most_times * self.scene.duration_s / self.whole[0][0].dt_s:
            return True
        self.not_tried_s = settings.dt_s
        return False

    def ends_with(self, settings: Settings, run: Run, check: _Check) -> bool:
        """Take a run; whether no further one is worth its cost."""
        self.costs.append((run.steps, run.wall_s))
        self.agreed_s = self.answer = None
        if check.before is not None and not run.outcome.failed:
            self.spreads.append(spread(check.before, run, self.target))
        if check.stopped:
            return True
        self.whole.append((settings, run))
        if run.outcome.failed:
            return False
        needed = self.agreements
        last = self.spreads[-1] if self.spreads and self.engine.agreements == needed else None
        # One comparison is enough that holds clearly; else so many must hold in a row.
        clear = last is not None and last.whole and CLEAR * last.stated.share_of(self.target) <= 1.0
        if clear or (len(self.spreads) >= needed and all(item.whole for item in self.spreads[-needed:])):
            self.agreed_s = run.end_s
        elif _fallen([each for _, each in self.whole], self.spreads, needed):
            self.agreed_s = run.no_return_time_s or 0.0
        else:
            return self.given_up(self.spreads, run) or (not self.promised and self._misses())
        return False

    def _misses(self) -> bool:
        """Whether the finest level would miss the target even if the last difference fell at the highest order."""
        if not self.spreads:
            return False
        last = self.spreads[-1]
        share = float((self.refinement_levels[-1].dt_s / last.fine_dt_s) ** MOST_ORDER)
        return last.stated_to_the_end.share_of(self.target) * min(share, 1.0) > 1.0

    def given_up(self, spreads: list[Spread], run: Run) -> bool:
        """Whether no finer run is expected to agree with its neighbour as long as a run is to be bounded."""
        finest_s = self.refinement_levels[-1].dt_s
        return bool(spreads) and (self.outgrown or hopeless(spreads, last_s(run), finest_s, self.target))

    def met(self, answer: Spread | None, until_s: float) -> bool:
        """Whether a slightly stronger motion moves less than the target until then, or finer steps would change little."""
        if answer is None or self.answers >= RESPONSES:
            return True
        return (answer.whole or answer.until_s >= until_s) and answer.largest.share_of(self.target) <= 1.0

    @property
    def promised(self) -> bool:
        """Whether a level is expected to meet the target."""
        return self.refinement_levels[-1].expected_error_rad <= START_SHARE * self.target.rotation_rad

    @property
    def agreements(self) -> int:
        """Comparisons that must hold in a row: those of the engine, more where the finest run leaves its events standing."""
        left = self._leaves(self.whole[-1][1])
        return max(self.engine.agreements, LEFT_AGREEMENTS) if left else self.engine.agreements

    def _leaves(self, run: Run) -> bool:
        """Whether a run leaves what its events are located for, other than in a fall."""
        left_s = plain_from_s(run)
        return left_s < math.inf and left_s < (run.no_return_time_s or math.inf)

    def response(self, until_s: float) -> Spread | None:
        """What a stronger motion changes in the coarser of the last two runs; None where it cannot be asked.

        Stronger by what the step is expected to err by, over 1 rad: a scene that turns the statue by as much as its motion
        changes (1 rad for all of it) makes of this share just the expected error. The two part where their rotations do: what
        a slip is moved by is stated, however much, as it may turn nothing.
        """
        good = [(settings, run) for settings, run in self.whole if not run.outcome.failed]
        if not good or not self.spreads or self.answer is not None:
            return self.answer
        settings, run = good[-2] if len(good) > 1 else good[-1]
        history = run.history

        def parted(t_s: float, theta_rad: float) -> bool:
            if history is None or t_s > run.end_s:
                return False
            return t_s > until_s or abs(float(history.at(t_s)) - theta_rad) > PARTED * self.target.rotation_rad

        scene = stronger(self.scene, good[-1][0].expected_error_rad)
        own = self.engine.sensitivity_settings(self.scene, settings)
        options = RunOptions(stop=parted, coarser_from_s=self.unbounded_from_s(settings))
        other = self.engine.simulate(scene, own, options)
        if not other.outcome.failed and history is not None:
            self.answer = spread(other, run, self.target, replace(self.target, slip_m=math.inf))
            self.answers += 1
            self.costs.append((other.steps, other.wall_s))
        return self.answer

    def best(self) -> tuple[Run, float | None]:
        """The finest run that was not ended early, and until when it and its neighbours agree; None where it has none."""
        runs = [run for _, run in self.whole]
        best = next((run for run in reversed(runs) if not run.outcome.failed), runs[-1])
        if best.outcome.failed or not self.spreads:
            return best, None
        if self.spreads[-1].whole:
            return best, best.end_s
        # The last comparison must hold, and the one before it if there is one or one is needed, or the last one clearly. One that
        # does not hold to the end is luck where runs part: up to an event at which the two before parted its two may agree.
        both_s = min(item.until_s for item in self.spreads[-2:]) if len(self.spreads) >= self.agreements else 0.0
        return best, max(self.spreads[-1].clear_s, both_s)

    def stated(self, best: Run, until_s: float | None, answer: Spread | None) -> Run:
        """The best run with what the spread to its neighbour says of it, and what a stronger motion changed in it."""
        work = {**best.work, "runs": len(self.costs), "steps_of_all_runs": sum(steps for steps, _ in self.costs)}
        best = whole = replace(best, work=work, wall_s=sum(wall_s for _, wall_s in self.costs))
        if not self.options.history and self.options.allows("no_history"):
            best = replace(best, history=None)
        if until_s is None:
            return best
        last = self.spreads[-1]
        answered = NONE if answer is None else answer.largest
        error = last.stated.or_more(_left(self.spreads, self.target), self._expected(best), answered)
        held_s = [until_s] if answer is None or answer.whole else [until_s, answer.until_s]
        if best.no_return_time_s is not None:
            # In a fall errors grow as the rotation itself does, and no second comparison is asked for.
            held_s.append(best.no_return_time_s)
        # All levels may lose alike what is too small for any: what that grows to is the scene's, not the step's.
        expected_rad = number(best.settings, "expected_error_rad")
        grown_s = outgrown_s(self.scene, expected_rad, self.target.rotation_rad / SAFETY)
        if grown_s <= best.end_s:
            error = error.or_more(replace(self.target, slip_m=0.0))
        if grown_s < math.inf:
            # What never passes a third of the target never passes it: the model's runs are asked twice where it matters.
            grown_s = outgrown_s(self.scene, expected_rad, self.target.rotation_rad)
        tips_s = unseen_tipping_s(self.scene, whole, expected_rad)
        slides_s = several_slides_s(self.scene, best)
        found, until_s = [], min([*held_s, grown_s, tips_s, slides_s])
        if until_s == slides_s:
            found.append(caution("several_slides", until_s=slides_s))
        elif until_s == tips_s:
            found.append(caution("tipping_not_resolved", until_s=tips_s))
        elif until_s < best.end_s:
            small_rad = PERTURBED_SHARE * expected_rad if until_s == grown_s else None
            found.append(_why_not_whole(best, last, until_s, self.target.rotation_rad, small_rad))
        elif error.rotation_rad > self.target.rotation_rad:
            found.append(caution("target_not_resolved", target_rad=self.target.rotation_rad))
        if self.not_tried_s is not None:
            found.append(caution("step_not_tried", dt_s=self.not_tried_s, times=self.options.most_times))
        if error.slip_m > self.target.slip_m * max(1.0, error.rotation_rad / self.target.rotation_rad):
            found.append(caution("slip_target_missed", slip_error_m=error.slip_m, target_m=self.target.slip_m))
        return best.with_uncertainty(error.rotation_rad, error.slip_m, until_s, *found)

    def _expected(self, run: Run) -> Error:
        """What a run's settings are expected to err by, more where its events are left; without a pedestal nothing slips."""
        rotation = FLOOR_SHARE * number(run.settings, "expected_error_rad", 0.0)
        if self._leaves(run):
            rotation *= plain_share(1.0, VERIFICATION_STEP_SHARE)
        height_m = 0.0 if self.scene.pedestal is None else self.scene.statue.centroid_height_m
        return Error(rotation, rotation * height_m)


class _Check:
    """Ends a run that has parted from the one before it, once no finer one is expected to bring the two together to the end."""

    def __init__(self, climb: _Climb, dt_s: float) -> None:
        before = climb.whole[-1][1] if climb.whole else None
        self.before = None if before is None or before.outcome.failed else before
        self.climb, self.target, self.dt_s = climb, climb.target, dt_s
        self.parted_s = math.inf
        self.stopped = False

    def __call__(self, t_s: float, theta_rad: float) -> bool:
        if self.before is None or self.before.history is None or t_s > self.before.end_s:
            return False
        if not self.climb.spreads and not self.climb.outgrown:
            return False
        apart = abs(float(self.before.history.at(t_s)) - theta_rad)
        before_s = number(self.before.settings, "dt_s")
        if apart > self.target.rotation_rad / factor(before_s, self.dt_s):
            self.parted_s = min(self.parted_s, t_s)
        if apart > PARTED * self.target.rotation_rad:
            now = Spread(NONE, self.parted_s, False, before_s, self.dt_s)
            self.stopped = self.climb.given_up([*self.climb.spreads, now], self.before)
        return self.stopped


def first_level(refinement_levels: tuple[Settings, ...], accuracy_rad: float, share: float) -> tuple[Settings, int]:
    """The coarsest level that may be expected to err by no more than this share of the accuracy, rad, and its place."""
    for index, settings in enumerate(refinement_levels):
        if settings.expected_error_rad <= share * accuracy_rad:
            return settings, index
    return refinement_levels[-1], len(refinement_levels) - 1


def second_level(levels: Sequence[Settings], first: int) -> int:
    """The place of the level that follows one and its verification run."""
    finest_s = VERIFICATION_STEP_SHARE * levels[first].dt_s
    return next((i for i in range(first + 1, len(levels)) if levels[i].dt_s < CLIMB_SHARE * finest_s), first)


def _factor(spreads: Sequence[Spread], target: Error) -> float:
    """How many times finer than the last step the next should be."""
    if not spreads or spreads[-1].apart.share_of(target) > PARTED:
        return 1.0
    needed = spreads[-1].stated_to_the_end.share_of(target) ** (1.0 / ORDER)
    return float(min(max(needed, 1.0), LEAP))


def _fallen(runs: list[Run], spreads: list[Spread], agreements: int) -> bool:
    """Whether the last runs agree until there is no return, and then overturn to the same side.

    In the fall that follows, differences grow as the rotation itself does: finer levels would tell its path, not its end.
    """
    last = [run for run in runs if not run.outcome.failed][-agreements - 1 :]
    if len(spreads) < agreements or len({run.outcome for run in last}) != 1:
        return False
    no_return_s = [math.inf if run.no_return_time_s is None else run.no_return_time_s for run in last]
    return all(item.until_s >= t_s for item, t_s in zip(spreads[-agreements:], no_return_s[1:], strict=True))


def _left(spreads: list[Spread], target: Error) -> Error:
    """What the comparison before the last leaves of its difference, at the highest order: the last two may agree by chance.

    Never more than the target, which the last comparison shows to be met.
    """
    if len(spreads) < 2 or not math.isfinite(spreads[-2].apart.rotation_rad):
        return NONE
    before, fine_dt_s = spreads[-2], spreads[-1].fine_dt_s
    left = before.stated_to_the_end.times((fine_dt_s / before.fine_dt_s) ** MOST_ORDER)
    return Error(min(left.rotation_rad, target.rotation_rad), min(left.slip_m, target.slip_m))


def _why_not_whole(best: Run, last: Spread, until_s: float, accuracy_rad: float, small_rad: float | None) -> Finding:
    if best.no_return_time_s is not None and until_s >= best.no_return_time_s:
        return info(
            "target_met_until_fall", target_rad=accuracy_rad, until_s=until_s, no_return_s=best.no_return_time_s
        )
    why = {"dt_s": last.coarse_dt_s if small_rad is None else None, "small_rad": small_rad}
    return caution("target_met_until", target_rad=accuracy_rad, until_s=until_s, end_s=best.end_s, **why)


# One engine on one scene: to an accuracy, or with an expert's own step; its failures told as outcomes.


DEFAULT_ACCURACY_RAD: Final = 1e-3
FINEST_DT_S: Final = 1e-6
"""Finer steps than this are refused: 10 s would take ten million of them."""


@dataclass(frozen=True)
class RunTarget:
    """What a run aims at: an accuracy, rad, or the expert's own step, s (neither: the default accuracy); and its options."""

    accuracy_rad: float | None = None
    dt_s: float | None = None
    options: RunOptions = field(default_factory=RunOptions)

    @property
    def target_rad(self) -> float:
        """The accuracy that is aimed at where no step is given, rad."""
        return self.accuracy_rad or DEFAULT_ACCURACY_RAD


def simulate(
    scene: Scene,
    engine: str,
    *,
    accuracy_rad: float | None = None,
    dt_s: float | None = None,
    options: RunOptions | None = None,
    overrides: Overrides = (),
) -> Run:
    """Compute one scene with one engine to an accuracy (default 1e-3 rad) or with an expert's own step.

    >>> run = harness.simulate(scene, "pymunk", accuracy_rad=1e-3)

    `overrides` replace keys of the scene as `scene.replace` does. An engine's own failure is a `Run` whose outcome says so.
    Raises `InputError` for an unknown engine or key, an accuracy or step out of range, or both given.
    """
    must_be_scene(scene, "simulate")
    check_target(accuracy_rad, dt_s)
    if overrides:
        scene = scene.replace(overrides)
    return simulate_with(engines.load(engine), scene, RunTarget(accuracy_rad, dt_s, options or RunOptions()))


def simulate_with(engine: Engine, scene: Scene, target: RunTarget) -> Run:
    """The same with an engine that is loaded, and a target that was checked."""
    reason, start, spent_s = engine.missing(), time.perf_counter(), time.thread_time()
    try:
        with own_failures(engine.name):
            if reason is not None:
                run = failed(engine.name, Outcome.UNAVAILABLE, reason)
            elif scene.initial.pose is not None and not engine.capabilities.posed_start:
                reason = (
                    f"{engine.name} does not begin from a pose in space (initial.position_m and its like): ask pybullet"
                )
                run = failed(engine.name, Outcome.CRASHED, reason)
            elif target.dt_s is not None and not engine.capabilities.certifies:
                run = engine.simulate(scene, engine.settings_for_dt(scene, target.dt_s), target.options)
            else:
                run = run_to_accuracy(engine, scene, target.target_rad, target.options)
    except EngineFailure as error:
        run = failed(engine.name, Outcome.CRASHED, str(error), time.perf_counter() - start)
        if isinstance(error, LayerFault):
            run = replace(run, validity={"layer_fault": error.code, **error.values})
    axes = scene.base_excitation.axes(engine.capabilities.dimensions)
    return replace(run, motion_axes=axes, cpu_s=time.thread_time() - spent_s)


def check_target(accuracy_rad: float | None, dt_s: float | None) -> None:
    """Raise `InputError` unless at most one of the two is given and it is in its range."""
    require(accuracy_rad is None or dt_s is None, "--accuracy and --dt", "one of the two", "both")
    require(
        accuracy_rad is None or 1e-9 <= accuracy_rad <= 0.1,
        "--accuracy",
        "a rotation between 1e-9 and 0.1 rad",
        f"{accuracy_rad!r}",
    )
    require(
        dt_s is None or FINEST_DT_S <= dt_s <= 0.1, "--dt", f"a step between {FINEST_DT_S:g} and 0.1 s", f"{dt_s!r}"
    )


def failed(engine: str, outcome: Outcome, message: str, wall_s: float = 0.0) -> Run:
    """A run that says why there is no answer."""
    return Run(
        engine=engine,
        outcome=outcome,
        history=None,
        settings={},
        steps=0,
        wall_s=wall_s,
        peak_theta_rad=0.0,
        peak_time_s=0.0,
        end_s=0.0,
        message=message,
    )
