"""A target accuracy instead of a time step: climb an engine's ladder until its own runs agree.

The error of a run is taken from the spread between it and a coarser run of the same engine with other settings (twice the
step, other order of bodies, fewer iterations), never from another model. Where errors fall at least in proportion to the step,
the finer run's is at most the spread over (the steps' ratio - 1); `harness.spread.SAFETY` covers that errors of contact fall
irregularly (tests/harness/test_uncertainty.py; `rockcheck bench` prints the coverage).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final

from harness.engine import Engine, Settings, Want
from harness.record import Run
from harness.scene import Scene
from harness.spread import CLEAR, Spread, factor, spread

START_SHARE: Final = 1.5
"""The first rung may be expected to miss the target by this much: the run that is kept is twice as fine."""
CLIMB_SHARE: Final = 0.75
"""A rung is worth a run when its step is shorter than all that were tried by at least this."""
LEAP: Final = 4.0
"""Factor by which the step may shrink at once, where two runs are so far apart that one halving would not do."""
ORDER: Final = 1.5
"""Order at which errors are expected to fall when that step is chosen."""
MOST_ORDER: Final = 2.0
"""Highest order that two differences are taken to show."""
FLOOR_SHARE: Final = 1.0
"""Share of a rung's expected error below which no uncertainty is stated: two runs may agree by chance."""
PARTED: Final = 4.0
"""Two runs that differ by this many times the target have parted for good."""


def run_to_accuracy(engine: Engine, scene: Scene, accuracy_rad: float, want: Want) -> Run:
    """Compute a scene to a target accuracy of the rotation, rad, at the least cost that the engine's own spread allows.

    The run states its uncertainty and until when it holds; where the target is not met for the whole run it says why. Raises
    `EngineFailure` when the engine cannot finish.
    """
    if engine.capabilities.certifies:
        return engine.simulate(scene, _first_rung(engine.ladder(scene), accuracy_rad, 1.0)[0], want)
    ladder = engine.ladder(scene)
    runs: list[Run] = []
    spreads: list[Spread] = []
    for settings in _climb(engine, scene, ladder, accuracy_rad, spreads):
        check = _Check(runs, spreads, settings.dt_s, ladder[-1].dt_s, accuracy_rad)
        run = engine.simulate(scene, settings, replace(want, history=True, stop=check))
        if runs and not run.outcome.failed and not runs[-1].outcome.failed:
            spreads.append(spread(runs[-1], run, accuracy_rad))
        if check.stopped:
            return _stated(runs, run, spreads, accuracy_rad, want, engine.agreements)
        runs.append(run)
        if run.outcome.failed:
            continue
        if _agreed(spreads, accuracy_rad, engine.agreements) or _fallen(runs, spreads, engine.agreements):
            break
        if _hopeless(spreads, run.end_s, ladder[-1].dt_s, accuracy_rad):
            break
    return _stated(runs, None, spreads, accuracy_rad, want, engine.agreements)


class _Check:
    """Ends a run that has parted from the one before it, once no finer one is expected to bring the two together to the end."""

    def __init__(
        self, runs: list[Run], spreads: list[Spread], dt_s: float, finest_dt_s: float, accuracy_rad: float
    ) -> None:
        self.before = runs[-1] if runs and not runs[-1].outcome.failed else None
        self.spreads, self.dt_s, self.finest_dt_s, self.accuracy_rad = spreads, dt_s, finest_dt_s, accuracy_rad
        self.parted_s = math.inf
        self.stopped = False

    def __call__(self, t_s: float, theta_rad: float) -> bool:
        if self.before is None or self.before.history is None or not self.spreads or t_s > self.before.end_s:
            return False
        apart = abs(float(self.before.history.at(t_s)) - theta_rad)
        before_s = float(self.before.settings["dt_s"])
        if apart > self.accuracy_rad / factor(before_s, self.dt_s):
            self.parted_s = min(self.parted_s, t_s)
        if apart > PARTED * self.accuracy_rad:
            now = Spread(0.0, self.parted_s, False, before_s, self.dt_s)
            self.stopped = _hopeless([*self.spreads, now], self.before.end_s, self.finest_dt_s, self.accuracy_rad)
        return self.stopped


def _first_rung(ladder: tuple[Settings, ...], accuracy_rad: float, share: float) -> tuple[Settings, int]:
    for index, settings in enumerate(ladder):
        if settings.expected_error_rad <= share * accuracy_rad:
            return settings, index
    return ladder[-1], len(ladder) - 1


def _climb(
    engine: Engine, scene: Scene, ladder: tuple[Settings, ...], accuracy_rad: float, spreads: Sequence[Spread]
) -> Iterator[Settings]:
    """Settings in the order in which they are tried: a rung, its probes, then rungs finer than these.

    `spreads` grows with the runs made: how far the last two were apart says how much finer the next must be.
    """
    index = _first_rung(ladder, accuracy_rad, START_SHARE)[1]
    while index < len(ladder):
        yield ladder[index]
        finest = ladder[index].dt_s
        for probe in engine.probes(scene, ladder[index]):
            yield probe
            finest = min(finest, probe.dt_s)
        # Two runs with one step would agree on an error that is the step's.
        finer = [i for i in range(index + 1, len(ladder)) if ladder[i].dt_s < CLIMB_SHARE * finest]
        wanted = finest / _factor(spreads, accuracy_rad)
        index = next((i for i in finer if ladder[i].dt_s <= wanted), finer[-1] if finer else len(ladder))


def _factor(spreads: Sequence[Spread], accuracy_rad: float) -> float:
    """How many times finer than the last step the next should be."""
    if not spreads or spreads[-1].apart_rad > PARTED * accuracy_rad:
        return 1.0
    needed = (spreads[-1].stated_to_the_end_rad / accuracy_rad) ** (1.0 / ORDER)
    return float(min(max(needed, 1.0), LEAP))


def _agreed(spreads: list[Spread], accuracy_rad: float, agreements: int) -> bool:
    """Whether as many comparisons as the engine needs hold in a row, or the last one holds clearly."""
    if spreads and spreads[-1].whole and CLEAR * spreads[-1].stated_rad <= accuracy_rad:
        return True
    return len(spreads) >= agreements and all(item.whole for item in spreads[-agreements:])


def _fallen(runs: list[Run], spreads: list[Spread], agreements: int) -> bool:
    """Whether the last runs agree until there is no return, and then overturn to the same side.

    In the fall that follows, differences grow as the rotation itself does: finer rungs would tell its path, not its end.
    """
    last = [run for run in runs if not run.outcome.failed][-agreements - 1 :]
    if len(spreads) < agreements or len({run.outcome for run in last}) != 1:
        return False
    no_return_s = [math.inf if run.no_return_time_s is None else run.no_return_time_s for run in last]
    return all(item.until_s >= t_s for item, t_s in zip(spreads[-agreements:], no_return_s[1:], strict=True))


def _hopeless(spreads: list[Spread], end_s: float, finest_dt_s: float, accuracy_rad: float) -> bool:
    """Whether no rung is expected to reach the end.

    A small difference grows in proportion to itself, so each halving of the step gains about the same time; unless runs keep
    together to the end and the next ones are expected to meet the target.
    """
    if len(spreads) < 2 or spreads[-1].whole:
        return False
    last, previous = spreads[-1], spreads[-2]
    if _falls(previous, last, finest_dt_s, accuracy_rad):
        return False
    gained = (last.until_s - previous.until_s) / math.log(previous.coarse_dt_s / last.coarse_dt_s)
    possible = gained * math.log(max(last.coarse_dt_s / finest_dt_s, 1.0))
    return possible < end_s - last.until_s


def _falls(previous: Spread, last: Spread, finest_dt_s: float, accuracy_rad: float) -> bool:
    """Whether the largest difference of two runs falls with the step, so fast that one leap should do."""
    if not last.apart_rad < previous.apart_rad < math.inf:
        return False
    order = math.log(previous.apart_rad / last.apart_rad) / math.log(previous.coarse_dt_s / last.coarse_dt_s)
    expected_rad = last.apart_rad * (last.fine_dt_s / last.coarse_dt_s) ** min(order, MOST_ORDER)
    next_s = max(last.fine_dt_s / LEAP, finest_dt_s)
    return order >= 1.0 and factor(last.fine_dt_s, next_s) * expected_rad <= accuracy_rad


def _stated(
    runs: list[Run], stopped: Run | None, spreads: list[Spread], accuracy_rad: float, want: Want, agreements: int
) -> Run:
    """The finest run that was not ended early, with what the spread to its neighbour says of it."""
    best = next((run for run in reversed(runs) if not run.outcome.failed), runs[-1])
    all_runs = runs if stopped is None else [*runs, stopped]
    work = {**best.work, "runs": len(all_runs), "steps_of_all_runs": sum(run.steps for run in all_runs)}
    best = replace(best, work=work, wall_s=sum(run.wall_s for run in all_runs))
    if not want.history and want.may_skip("no_history"):
        best = replace(best, history=None)
    if best.outcome.failed or not spreads:
        return best
    last = spreads[-1]
    expected = float(best.settings.get("expected_error_rad", 0.0))
    uncertainty = max(last.stated_rad, _left_rad(spreads, accuracy_rad), FLOOR_SHARE * expected)
    if last.whole and uncertainty <= accuracy_rad:
        return best.with_uncertainty(uncertainty, best.end_s)
    if last.whole:
        return best.with_uncertainty(
            uncertainty, best.end_s, f"the target of {accuracy_rad:g} rad is below what the engine's contact resolves"
        )
    until_s = _held_until_s(spreads, agreements)
    return best.with_uncertainty(uncertainty, until_s, _why_not_whole(best, last, until_s, accuracy_rad))


def _left_rad(spreads: list[Spread], accuracy_rad: float) -> float:
    """What the comparison before the last leaves of its difference, at the highest order: the last two may agree by chance.

    Never more than the target, which the last comparison shows to be met.
    """
    if len(spreads) < 2 or not math.isfinite(spreads[-2].apart_rad):
        return 0.0
    before, fine_dt_s = spreads[-2], spreads[-1].fine_dt_s
    return float(min(before.stated_to_the_end_rad * (fine_dt_s / before.fine_dt_s) ** MOST_ORDER, accuracy_rad))


def _held_until_s(spreads: list[Spread], agreements: int) -> float:
    """Until when the last comparison holds, and those before it that the engine needs nearly, or the last one holds clearly."""
    last = spreads[-1]
    before = [item.near_s for item in spreads[-agreements:-1]]
    return max(last.clear_s, min([last.until_s, *before]) if len(before) == agreements - 1 else 0.0)


def _why_not_whole(best: Run, last: Spread, until_s: float, accuracy_rad: float) -> str:
    until = f"the target of {accuracy_rad:g} rad is met until {until_s:.4g} s of {best.end_s:.4g} s"
    if best.no_return_time_s is not None and until_s >= best.no_return_time_s:
        return f"{until}, past the instant of no return at {best.no_return_time_s:.4g} s: in the fall every difference grows"
    return (
        f"{until}: from there two settings of this engine part, with steps of {last.coarse_dt_s:g} s and finer, and its "
        "numerical error is not bounded; the horizon of prediction tells whether anybody could compute it further"
    )
