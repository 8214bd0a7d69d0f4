"""Numbers of the contact engines for `rockcheck bench`: error and cost for each setting, cost of the harness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from analytic.constants import GRAVITY_M_S2
from analytic.excitation import Harmonic
from harness import engines
from harness.engines.base import Settings
from harness.model.options import RunOptions
from harness.model.run import Run
from harness.model.scene import BaseExcitation, Contact, Form, Pedestal, Scene, Statue

CASES: Final = ((0.334, 2.0), (0.334, 3.0), (0.429, 2.0), (0.429, 3.0))
"""Amplitude in g and frequency in Hz of the paper's cases that every setting is measured on."""
BEST_OF: Final = 5


def paper_scene(
    amplitude_g: float,
    frequency_hz: float,
    *,
    pedestal: bool,
    static: float,
    ratio: float | None = None,
    duration_s: float = 1.0,
) -> Scene:
    """The surveyed statue as a block (docs/model.md, section 1), μ_k = 0.15."""
    left, right, height, depth = 0.3585, 0.0682, 1.46, 0.72
    section = np.array([[-left, 0.0], [right, 0.0], [right, height], [-left, height]])
    half = 0.5 * depth
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    mass, inertia = 707.0, 152.4
    across, along = mass * (left + right) ** 2 / 12.0, mass * depth**2 / 12.0
    tensor = np.diag([inertia - across + along, inertia, across + along])
    return Scene(
        title=f"{amplitude_g:g} g, {frequency_hz:g} Hz",
        duration_s=duration_s,
        gravity_m_s2=GRAVITY_M_S2,
        form=Form(),
        statue=Statue(mass, 0.774, left, right, inertia, height, depth, section, footprint, tensor),
        pedestal=Pedestal(250.0, 0.60, 0.80, 0.20) if pedestal else None,
        contact=Contact(static, 0.15, 1.0, ratio),
        base_excitation=BaseExcitation(x=Harmonic(amplitude_g * GRAVITY_M_S2, frequency_hz)),
    )


def accuracy_rows(names: Sequence[str], steps_s: Sequence[float]) -> Iterator[dict[str, Any]]:
    """For each engine, step and kind of scene: largest error against the analytic model in the first second, and the cost."""
    model = engines.load("analytic")
    kinds = (
        ("no pedestal", False, 0.15, None),
        ("pedestal", True, 0.15, None),
        ("two frictions", True, 0.20, None),
        ("imposed 0.85", True, 0.20, 0.85),
        ("imposed 0.90", True, 0.20, 0.90),
    )
    for kind, pedestal, static, ratio in kinds:
        scenes = [paper_scene(a, f, pedestal=pedestal, static=static, ratio=ratio) for a, f in CASES]
        exact = [model.simulate(scene, model.refinement_levels(scene)[1], RunOptions()) for scene in scenes]
        for name in names:
            engine = engines.load(name)
            if engine.missing() is not None:
                yield {"engine": name, "kind": kind, "missing": engine.missing()}
                continue
            for dt in steps_s:
                runs = [engine.simulate(scene, engine.settings_for_dt(scene, dt), RunOptions()) for scene in scenes]
                errors = [apart(a, b) for a, b in zip(runs, exact, strict=True)]
                yield {
                    "engine": name,
                    "kind": kind,
                    "dt_s": dt,
                    "error_rad": max(error[0] for error in errors),
                    "error_slip_m": max(error[1] for error in errors),
                    "us_per_step": 1e6 * sum(run.wall_s for run in runs) / sum(run.steps for run in runs),
                }


def apart(run: Run, exact: Run) -> tuple[float, float]:
    """Largest differences of rotation, rad, and slip, m, while both runs last; nan where a history is missing."""
    if run.history is None or exact.history is None:
        return float("nan"), float("nan")
    times = exact.history.t_s[exact.history.t_s <= min(run.end_s, exact.end_s)]
    theta = np.abs(run.history.at(times) - exact.history.at(times))
    slip = np.abs(
        np.interp(times, run.history.t_s, run.history.slip_m)
        - np.interp(times, exact.history.t_s, exact.history.slip_m)
    )
    return float(np.max(theta)), float(np.max(slip))


def overhead(duration_s: float = 10.0, dt_s: float = 2.5e-4) -> dict[str, float]:
    """Cost of a whole pymunk run (split steps, record, reduction) over a bare loop with the same settings and read-outs."""
    from harness.engines.pymunk.baseline_loop import bare_loop
    from harness.engines.pymunk.world import MunkSettings

    engine = engines.load("pymunk")
    found: dict[str, float] = {}
    for kind, pedestal in (("no_pedestal", False), ("pedestal", True)):
        # Small enough that the statue does not fall: both loops then make the same steps.
        scene = paper_scene(0.2, 5.0, pedestal=pedestal, static=0.15, duration_s=duration_s)
        settings: Settings = engine.settings_for_dt(scene, dt_s)
        if not isinstance(settings, MunkSettings):
            raise TypeError("pymunk's settings are wanted")
        own, bare = [], []
        for _ in range(BEST_OF):
            own.append(engine.simulate(scene, settings, RunOptions(skips=frozenset())).wall_s)
            bare.append(bare_loop(scene, replace(settings))[0])
        found[f"{kind}_bare_s"], found[f"{kind}_run_s"] = min(bare), min(own)
        found[f"{kind}_ratio"] = min(own) / min(bare)
    return found
