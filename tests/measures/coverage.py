"""Is the stated numerical uncertainty honest? What a run stated beside a much finer one, and seeded scenes to ask it of."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.block import GRAVITY_M_S2
from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration
from harness.comparison.scores import errors
from harness.engines.base import Engine
from harness.model import BaseExcitation, Contact, Form, Pedestal, Run, RunOptions, Scene, Statue

REFERENCE_STEP_DIVISOR: Final = 5.0
"""The run that stands for the truth has a step this many times finer than the finest of the target's own two."""
DURATION_S: Final = 3.0


@dataclass(frozen=True)
class Statement:
    """What a run stated of itself, and what it was off by while that is said to hold (None: it kept no history)."""

    engine: str
    outcome: str
    dt_s: float | None
    runs: int
    steps: int
    stated_rad: float
    stated_m: float
    reliable_until_s: float
    end_s: float
    error_rad: float | None
    error_m: float | None
    plain_from_s: float | None = None

    @property
    def rotation_holds(self) -> bool:
        """Whether the error of the rotation stays within the statement."""
        return self.error_rad is not None and self.error_rad <= self.stated_rad

    @property
    def slip_holds(self) -> bool:
        """Whether that of the slip does."""
        return self.error_m is not None and self.error_m <= self.stated_m

    @property
    def share(self) -> float:
        """For what share of the run's length it is said to hold."""
        return self.reliable_until_s / self.end_s if self.end_s > 0.0 else 1.0


def statement(run: Run, truth: Run) -> Statement:
    """A run's statement against the run that stands for the truth."""
    until_s = run.bounded_until_s
    rotation, slip = errors(run, truth, until_s)
    return Statement(
        run.engine, run.outcome.value, run.settings.get("dt_s"), int(run.work.get("runs", 1)),
        int(run.work.get("steps_of_all_runs", run.steps)), run.numerical_uncertainty_rad or 0.0,
        run.slip_uncertainty_m or 0.0, until_s, run.end_s, rotation, slip, run.validity.get("plain_from_s"),
    )  # fmt: skip


def truth_of(engine: Engine, scene: Scene, run: Run, until_s: float, finest_s: float = 0.0) -> Run:
    """A much finer run of the same engine up to a time, its step not below the finest; of one that certifies, its finest."""
    if engine.capabilities.certifies:
        return engine.simulate(scene, engine.refinement_levels(scene)[-1], RunOptions())
    settings = engine.settings_for_dt(scene, max(float(run.settings["dt_s"]) / REFERENCE_STEP_DIVISOR, finest_s))
    return engine.simulate(scene, settings, RunOptions(stop=lambda t_s, _: t_s > until_s))


def random_scene(seed: int, duration_s: float = DURATION_S) -> Scene:
    """A reproducible scene: a statue of any size and asymmetry, pedestal or none, any friction, harmonic, pulse or record."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(0.3, 1.2)
    left, right = height * rng.uniform(0.08, 0.5, 2)
    mass = rng.uniform(50.0, 900.0)
    depth = 0.8 * (left + right)
    inertia = mass * (height**2 + 0.25 * (left + right) ** 2) / 3.0 * rng.uniform(0.7, 1.2)
    statue = block(mass, float(left), float(right), height, inertia, depth)
    pedestal = None
    if rng.random() < 0.5:
        width = (left + right) * rng.uniform(1.1, 2.0)
        pedestal = Pedestal(mass * rng.uniform(0.2, 1.5), float(width), depth, height * rng.uniform(0.1, 0.4))
    kinetic = rng.uniform(0.08, 0.4)
    static = kinetic * rng.uniform(1.0, 1.4)
    limit = GRAVITY_M_S2 * min(left, right) / height
    excitation = BaseExcitation(x=_excitation(rng, limit * rng.uniform(1.1, 4.0)))
    return seeded(f"seed {seed}", duration_s, statue, pedestal, Contact(static, kinetic, 2.0), excitation)


def block(mass: float, left: float, right: float, height: float, inertia: float, depth: float) -> Statue:
    """A rectangular body of the given centroid height and corners, twice as high as its centroid."""
    top, half = 2.0 * height, 0.5 * depth
    section = np.array([[-left, 0.0], [right, 0.0], [right, top], [-left, top]])
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    across, along = mass * (left + right) ** 2 / 12.0, mass * depth**2 / 12.0
    tensor = np.diag([inertia - across + along, inertia, across + along])
    return Statue(mass, height, left, right, inertia, top, depth, section, footprint, tensor)


def seeded(
    title: str, duration_s: float, statue: Statue, pedestal: Pedestal | None, contact: Contact, motion: BaseExcitation
) -> Scene:
    """A scene of the model's consistent form, on earth."""
    return Scene(title, duration_s, GRAVITY_M_S2, Form(), statue, pedestal, contact, motion)


def _excitation(rng: np.random.Generator, peak_m_s2: float) -> Excitation:
    kind = int(rng.integers(3))
    if kind == 0:
        return Harmonic(peak_m_s2, float(rng.uniform(0.8, 5.0)))
    if kind == 1:
        return Pulse("one_sine", peak_m_s2, float(rng.uniform(0.2, 1.2)), float(rng.uniform(0.0, 0.5)))
    times = np.linspace(0.0, DURATION_S, 151)
    noise = rng.normal(size=times.size)
    smooth = np.convolve(noise, np.hanning(9), mode="same") * np.sin(np.pi * times / DURATION_S)
    return SampledAcceleration(times, peak_m_s2 * smooth / np.max(np.abs(smooth)))
