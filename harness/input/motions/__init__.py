"""Shake-table motions: records, pulses, spectrum-compatible histories and the building's filter."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from analytic.excitation import Excitation, Harmonic, Pulse, ZeroExcitation
from harness.input.mistakes import Contradiction
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2, Series, mistake
from harness.input.motions.spec import (
    Component,
    HarmonicSpec,
    Oscillator,
    PulseSpec,
    RecordSpec,
    RestSpec,
    SamplesSpec,
    SpectrumSpec,
)
from harness.model import Finding, info, require

if TYPE_CHECKING:
    from harness.input.motions.spectra import DesignSpectrum
    from harness.input.tables import SceneFile

MOST_PERIODS: Final = 150_000
"""Periods of a floor's stiffest mode in its motion: ten million samples (`process.POINTS_PER_PERIOD`), ten seconds and 1 GB."""


@dataclass(frozen=True, eq=False)
class PreparedMotion:
    """An excitation, the steps that led to it, what is doubtful, and the target it follows (none behind a building)."""

    excitation: Excitation
    done: tuple[Finding, ...] = ()
    findings: tuple[Finding, ...] = ()
    target: DesignSpectrum | None = None


@dataclass(frozen=True)
class SceneMotion:
    """One component of a scene's motion, and what of the scene it needs; `where` and `key` name it in messages.

    `duration_s` is the scene's: only a harmonic motion through a building needs it. `gravity_m_s2` is the scene's: formulas give
    their amplitude as a share of it, so that a block's limits in g are exact; records in g mean standard gravity. `scale` is
    what the scene multiplies all its components by.
    """

    component: Component
    base_dir: Path
    where: str
    key: str
    duration_s: float | None = None
    gravity_m_s2: float = STANDARD_GRAVITY_M_S2
    scale: float = 1.0

    @classmethod
    def of(cls, scene: SceneFile, axis: str, path: Path) -> SceneMotion | None:
        """The component of a scene file along an axis, None where it has none."""
        component: Component | None = getattr(scene.motion, axis)
        if component is None:
            return None
        key, scale = f"motion.{axis}", scene.motion.scale
        return cls(component, path.parent, str(path), key, scene.duration_s, scene.gravity_m_s2, scale)


def prepare(motion: SceneMotion) -> PreparedMotion:
    """The excitation of one component with its record of steps and findings. Raises InputError."""
    component = motion.component
    if isinstance(component, RestSpec):
        return PreparedMotion(ZeroExcitation())
    if isinstance(component, HarmonicSpec):
        phase = math.radians(component.phase_deg)
        peak_m_s2 = component.amplitude_g * motion.gravity_m_s2
        ground = PreparedMotion(Harmonic(peak_m_s2, component.frequency_hz, phase, component.ramp_s))
    elif isinstance(component, PulseSpec):
        peak_m_s2 = component.amplitude_g * motion.gravity_m_s2
        ground = PreparedMotion(Pulse(component.shape, peak_m_s2, component.duration_s, component.start_s))
    elif isinstance(component, RecordSpec):
        # A motion by formula loads no reader of records.
        from harness.input.motions import records

        ground = _of_series(*records.load(component, base_dir=motion.base_dir, where=motion.where, key=motion.key))
    elif isinstance(component, SamplesSpec):
        ground = _of_series(Series(component.dt_s, np.array(component.accel_m_s2)), ())
    else:
        ground = _compatible(component, motion)
    moved = _on_floor(ground, component.floor, motion) if component.floor else ground
    if motion.scale == 1.0:
        return moved
    done = (*moved.done, info("step_scaled", factor=motion.scale, why="scale", target=""))
    return replace(moved, excitation=moved.excitation.scaled(motion.scale), done=done)


def _of_series(series: Series, findings: tuple[Finding, ...], target: DesignSpectrum | None = None) -> PreparedMotion:
    return PreparedMotion(series.excitation(), series.done, findings, target)


def _compatible(component: SpectrumSpec, motion: SceneMotion) -> PreparedMotion:
    from harness.input.motions import process, records, spectra

    spectrum, where, key = spectra.design_spectrum(component), motion.where, motion.key
    try:
        if component.record is None:
            duration = component.duration_s or spectra.DEFAULT_DURATION_S
            made = spectra.artificial(spectrum, seed=component.seed or 0, duration_s=duration)
            return _of_series(made, (), spectrum)
        series, findings = records.load(component.record, base_dir=motion.base_dir, where=where, key=f"{key}.record")
        if component.method != "scale":
            series = process.resample(series, spectra.STEP_S)
        factor = spectra.best_factor(series, spectrum)
        series = process.scaled(series, factor, "nearest", spectrum.name)
        if component.method != "scale":
            series = spectra.match(series, spectrum)
        return _of_series(series, findings, spectrum)
    except Contradiction as error:
        wanted = f"a record that can be sampled at {spectra.STEP_S} s"
        raise mistake(where, f"{key}.record", wanted, f"{error.got}: wanted {error.wanted}") from error
    except spectra.NoMatchError as error:
        advice = 'try another seed or record, a longer duration, or method = "scale"'
        wanted = f"a misfit within {spectra.MISFIT:.0%}"
        raise mistake(where, key, wanted, str(error), advice) from error


def _on_floor(ground: PreparedMotion, modes: tuple[Oscillator, ...], motion: SceneMotion) -> PreparedMotion:
    from harness.input.motions.process import floor_motion, ring_down_s

    where, key, duration_s = motion.where, motion.key, motion.duration_s
    until = min(ground.excitation.end_s + ring_down_s(modes), math.inf if duration_s is None else duration_s)
    require(
        math.isfinite(until),
        where,
        "a motion that ends, or the scene's duration_s",
        "a harmonic motion without end",
        key=f"{key}.floor",
    )
    shortest_s = min(mode.period_s for mode in modes)
    require(
        until / shortest_s <= MOST_PERIODS,
        where,
        f"at least {until / MOST_PERIODS:.2g} s for {until:.4g} s of motion",
        f"{shortest_s:g}",
        "so stiff a mode moves with the ground: leave it out",
        key=f"{key}.floor.period_s",
    )
    periods_s, dampings, shares = zip(*((mode.period_s, mode.damping, mode.share) for mode in modes), strict=True)
    moved = floor_motion(ground.excitation, modes, until)
    step = info("step_floor", to_s=until, periods_s=periods_s, dampings=dampings, shares=shares)
    return PreparedMotion(moved, (*ground.done, step), ground.findings)
