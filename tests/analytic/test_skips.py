"""What is skipped changes nothing: the same run with and without each skip."""

import numpy as np
import pytest

from analytic import (
    AnalyticInputError,
    Block,
    Excitation,
    Harmonic,
    Outcome,
    Pedestal,
    Pulse,
    Record,
    Rest,
    Solution,
    Wall,
    simulate,
)
from tests.analytic.paestum import GRAVITY, PEDESTAL, STATUE
from tests.budgets_analytic import EVENT_REL, SKIP_RAD

TIMES = np.arange(0.0, 20.0, 0.02)
ENVELOPE = np.exp(-(((TIMES - 10.0) / 2.0) ** 2))
RECORD = Record(TIMES, 4.0 * ENVELOPE * np.sin(2.0 * np.pi * 2.1 * TIMES))
FLOOR = {"duration_s": 25.0, "gravity_m_s2": GRAVITY}
ON_PEDESTAL = FLOOR | {"pedestal": PEDESTAL, "floor_static": 0.20, "floor_kinetic": 0.15}


def largest_difference(a: Solution, b: Solution) -> float:
    columns = [(a.theta_rad, b.theta_rad), (a.theta_rate_rad_s, b.theta_rate_rad_s), (a.slip_m, b.slip_m)]
    assert np.array_equal(a.t_s, b.t_s)
    return max(float(np.abs(x - y).max()) for x, y in columns)


@pytest.mark.parametrize("scene", [FLOOR, ON_PEDESTAL], ids=["floor", "pedestal"])
@pytest.mark.parametrize("vertical", [Rest(), Record(TIMES[::2], 1.0 * ENVELOPE[::2])], ids=["flat", "vertical"])
def test_quiet_times_are_skipped_bit_for_bit(scene: dict[str, object], vertical: Excitation) -> None:
    on = simulate(STATUE, RECORD, vertical, **scene)  # type: ignore[arg-type]
    off = simulate(STATUE, RECORD, vertical, skip_start=False, skip_rest=False, **scene)  # type: ignore[arg-type]
    assert on.peak_theta_rad > 0.0
    assert on.counts.quiet_samples > 200
    assert off.counts.quiet_samples == 0
    assert on.counts.steps < off.counts.steps - 200
    assert largest_difference(on, off) <= SKIP_RAD
    assert on.events == off.events


@pytest.mark.parametrize("scene", [FLOOR, ON_PEDESTAL], ids=["floor", "pedestal"])
@pytest.mark.parametrize("factor", [-3.0, 0.1, 0.3, 0.5, 1.0])
def test_weak_samples_are_passed_at_once_where_the_outcome_alone_is_asked(
    scene: dict[str, object], factor: float
) -> None:
    """The same steps and the same samples left out, to the bit of the peak: with the forces looked at each sample is weighed."""
    asked = {"dt_s": None, "events": False} | scene
    bare, looked = (simulate(STATUE, RECORD.scaled(factor), validity=each, **asked) for each in (False, True))  # type: ignore[arg-type]
    assert (bare.outcome, bare.peak_theta_rad, bare.end_s) == (looked.outcome, looked.peak_theta_rad, looked.end_s)
    assert (bare.counts.steps, bare.counts.quiet_samples) == (looked.counts.steps, looked.counts.quiet_samples)
    assert bare.counts.quiet_samples > 200
    assert bare.results.skipped_s == pytest.approx(looked.results.skipped_s)


def test_a_motion_below_every_limit_is_not_integrated_at_all() -> None:
    weak = RECORD.scaled(0.1)
    on = simulate(STATUE, weak, **ON_PEDESTAL)  # type: ignore[arg-type]
    off = simulate(STATUE, weak, skip_start=False, **ON_PEDESTAL)  # type: ignore[arg-type]
    assert on.counts.steps == 0
    assert off.counts.steps > 900
    assert on.outcome == off.outcome
    assert largest_difference(on, off) <= SKIP_RAD


def test_rest_after_the_motion_is_detected() -> None:
    run = simulate(STATUE, Pulse("one_sine", -2.0, 0.5), **(FLOOR | {"duration_s": 1000.0}), dt_s=1.0)  # type: ignore[arg-type]
    assert run.outcome.value == "stands"
    assert run.results.skipped_s > 900.0
    assert run.counts.steps < 600


@pytest.mark.parametrize("scene", [FLOOR, ON_PEDESTAL], ids=["floor", "pedestal"])
@pytest.mark.parametrize("factor", [0.5, 0.8, 1.0, 1.3, 1.7, 2.5, 4.0])
def test_energy_decides_as_integration_does(scene: dict[str, object], factor: float) -> None:
    motion = Pulse("one_sine", -2.5 * factor, 0.7)
    outcomes, peaks = {}, []
    for name, options in (("energy", {}), ("integrated", {"skip_energy": False}), ("history", {"dt_s": 0.01})):
        run = simulate(STATUE, motion, **({"dt_s": None} | scene | options))  # type: ignore[arg-type]
        outcomes[name] = run.outcome
        peaks.append(run.peak_signed_rad)
    assert len(set(outcomes.values())) == 1, outcomes
    assert max(peaks) - min(peaks) <= SKIP_RAD, (
        "the largest rotation may lie after the time at which the energy decides"
    )


def test_energy_ends_runs_early() -> None:
    motion = Pulse("one_sine", -2.5, 0.7)
    on = simulate(STATUE, motion, dt_s=None, **FLOOR)  # type: ignore[arg-type]
    off = simulate(STATUE, motion, dt_s=None, skip_energy=False, **FLOOR)  # type: ignore[arg-type]
    assert on.counts.energy_endings
    assert on.counts.steps < off.counts.steps
    assert on.end_s < off.end_s
    assert on.outcome == off.outcome


def test_no_history_leaves_the_outcome_and_the_peak() -> None:
    for amplitude, frequency in ((0.334, 3.0), (0.429, 2.0), (0.429, 6.0)):
        motion = Harmonic(amplitude * GRAVITY, frequency)
        full = simulate(STATUE, motion, **ON_PEDESTAL)  # type: ignore[arg-type]
        bare = simulate(STATUE, motion, dt_s=None, events=False, validity=False, **ON_PEDESTAL)  # type: ignore[arg-type]
        assert bare.outcome == full.outcome
        assert bare.peak_theta_rad == full.peak_theta_rad
        assert bare.overturn_time_s == full.overturn_time_s
        assert bare.t_s.size == 0
        assert bare.events == ()


def test_the_start_and_later_rests_are_skipped_each_by_its_own_switch() -> None:
    def steps(**options: bool) -> tuple[int, int, float]:
        run = simulate(STATUE, RECORD.scaled(0.3), **options, **(FLOOR | {"duration_s": 60.0}))  # type: ignore[arg-type]
        return run.counts.steps, run.counts.quiet_samples, run.peak_theta_rad

    both, start, rest = steps(), steps(skip_rest=False), steps(skip_start=False)
    none = steps(skip_start=False, skip_rest=False)
    assert both[0] < min(start[0], rest[0]), "each leaves out what the other integrates"
    assert max(start[0], rest[0]) < none[0]
    assert none[1] == 0
    assert both[2] == start[2] == rest[2] == none[2]


def worn(random: np.random.Generator) -> Block | None:
    """A body with a convex base of three to seven vertices, half of them with a level facet; None where the draw is none."""
    half_m, height_m, count = random.uniform(0.05, 0.3), random.uniform(0.4, 1.5), int(random.integers(3, 8))
    x = np.sort(random.uniform(-half_m, half_m, count))
    slopes = random.uniform(-0.3, 0.3, count - 1)
    slopes[0] *= random.random() < 0.5
    slopes = np.sort(slopes)
    if np.diff(x).min() < 0.003 or np.diff(slopes).min() < 0.002:
        return None
    z = np.concatenate([[0.0], np.cumsum(slopes * np.diff(x))])
    profile = tuple(zip(x.tolist(), (z - z.min()).tolist(), strict=True))
    try:
        return Block(100.0, height_m, 33.0 * height_m**2 * random.uniform(0.8, 1.2), profile)
    except AnalyticInputError:  # no base under the centroid
        return None


@pytest.mark.parametrize("beside", ["", "pedestal", "wall"])
def test_energy_decides_on_worn_bases_as_integration_does(beside: str) -> None:
    """Also where the motion is too weak to reach the facet towards which it goes: it turns back, and gains nothing."""
    random, below = (
        np.random.default_rng(12),
        {"pedestal": Pedestal(200.0, 1.0, 0.3), "floor_static": 0.8} if beside == "pedestal" else {},
    )
    decided = 0
    for _ in range(600):
        block = worn(random)
        small = random.choice([-1.0, 1.0]) * 10.0 ** random.uniform(-12.0, -1.0)
        rate = random.uniform(-0.6, 0.6) * 10.0 ** random.uniform(-3.0, 0.0) * (random.random() < 0.6)
        if block is None:
            continue
        start = {"theta0_rad": float(small), "theta_rate0_rad_s": float(rate), "duration_s": 60.0, "dt_s": None} | below
        if beside == "wall":  # as near as the lean at the start leaves room, and a little more
            top_m, corner_m = 2.0 * block.centroid_height_m, block.profile_m[-1][0]
            outline = (*block.profile_m, (corner_m, top_m), (-corner_m, top_m))
            start["wall"] = Wall("right", abs(float(small)) * top_m + random.uniform(0.005, 0.05), outline)
        by_energy, integrated = (simulate(block, Rest(), skip_energy=skip, **start) for skip in (True, False))
        decided += by_energy.counts.energy_endings
        if integrated.outcome is not Outcome.UNDECIDED:  # still rocking at the end
            assert by_energy.outcome is integrated.outcome
            assert by_energy.peak_theta_rad == pytest.approx(integrated.peak_theta_rad, rel=1e-6, abs=1e-7)
    assert decided > 150


@pytest.mark.parametrize("amplitude_g", [0.34, 0.48, 0.523, 0.537, 0.62])
def test_energy_tells_the_instant_of_no_return_and_of_no_peak_to_come(amplitude_g: float) -> None:
    """A statue beyond its balance as the blow ends comes back, and falls seconds later, to either side."""
    block = Block.two_corners(
        mass_kg=100.0, centroid_height_m=1.0, corner_left_m=0.18, corner_right_m=0.2, inertia_kg_m2=36.0
    )
    blow = Pulse("one_sine", amplitude_g * GRAVITY, 0.9)
    whole, alone = (simulate(block, blow, duration_s=6.0, dt_s=dt) for dt in (0.01, None))
    assert alone.counts.energy_endings
    assert alone.outcome is whole.outcome
    assert alone.no_return_time_s == pytest.approx(whole.no_return_time_s, rel=EVENT_REL)
    assert alone.peak_time_s is None
    short = simulate(block, blow, duration_s=1.1, dt_s=0.01)
    assert short.no_return_time_s is None or short.no_return_time_s == pytest.approx(whole.no_return_time_s)
