"""What a motion is made of, for a table, a picture and JSON: `rockcheck motion inspect FILE`."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytic.excitation import SampledAcceleration
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.readers import read_record
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2, Floats, Layout, Series
from harness.input.motions.records import aligned
from harness.input.motions.spectra import DesignSpectrum, Measures, measures, spectrum_m_s2
from harness.model import SCHEMA_VERSION, Finding, Say, info, texted, to_plain

DAMPING: Final = 0.05
PERIODS_S: Final = np.geomspace(0.03, 4.0, 80)
ENDLESS_S: Final = 20.0
"""Shown of a harmonic motion that never ends and whose scene gives no duration."""
_FINE_STEP_S = 0.005
_SAMPLES_PER_PERIOD = 400
"""Or in a pulse."""
_MOST_SAMPLES = 1_000_000
_ROWS: Final = {
    "pga_g": "{:.4f}",
    "pgv_m_s": "{:.4f}",
    "pgd_m": "{:.4f}",
    "pgv_to_pga_s": "{:.4f}",
    "arias_m_s": "{:.3f}",
    "significant_5_95_s": "{:.2f}",
    "significant_5_75_s": "{:.2f}",
    "bracketed_s": "{:.2f}",
    "end_velocity_m_s": "{:.2e}",
    "end_displacement_m": "{:.2e}",
}


@dataclass(frozen=True, eq=False)
class Trace:
    """One channel: its history, measures and pseudo-acceleration spectrum (m/s²) at PERIODS_S."""

    name: str
    direction: str
    series: Series
    measures: Measures
    spectrum_m_s2: Floats


@dataclass(frozen=True, eq=False)
class MotionInspection:
    """Traces on one clock, where they came from, what was done, what is doubtful, and the target they were to follow."""

    title: str
    source: dict[str, str]
    traces: tuple[Trace, ...]
    findings: tuple[Finding, ...] = ()
    target: DesignSpectrum | None = None

    def table(self) -> list[tuple[str, ...]]:
        """Rows of text: a header, then by name, which ends in its unit, a value for every trace."""
        head = ("", *(f"{trace.name} ({trace.direction})" for trace in self.traces))
        sizes = ("samples", *(f"{t.series.accel_m_s2.size} × {t.series.dt_s:g} s" for t in self.traces))
        rows = [(key, *(form.format(getattr(t.measures, key)) for t in self.traces)) for key, form in _ROWS.items()]
        return [head, sizes, *rows]

    def record(self, say: Say) -> dict[str, Any]:
        """All but the histories as plain values, the findings and what was done said by `say`.

        Of each channel its samples, what was done to it, its measures and its pseudo-acceleration spectrum; of a design spectrum
        that the motion was to follow its value at the same periods.
        """
        target, findings = self.target, texted(self.findings, say)
        traces = [
            {
                "name": trace.name,
                "direction": trace.direction,
                "dt_s": trace.series.dt_s,
                "samples": trace.series.accel_m_s2.size,
                "done": [say(step) for step in trace.series.done],
                "measures": trace.measures,
                "spectrum_m_s2": trace.spectrum_m_s2,
            }
            for trace in self.traces
        ]
        values: dict[str, Any] = to_plain(
            {
                "schema_version": SCHEMA_VERSION,
                "title": self.title,
                "source": self.source,
                "damping": DAMPING if target is None else target.damping,
                "periods_s": PERIODS_S,
                "traces": traces,
                "target": target and {**asdict(target), "spectrum_m_s2": target.accel_m_s2(PERIODS_S)},
                "warnings": [each.text for each in findings],
                "findings": findings,
            }
        )
        return values


def inspect_file(
    path: Path, *, unit: str | None = None, layout: Layout | None = None, target: DesignSpectrum | None = None
) -> MotionInspection:
    """The record in `path` as it is, with its sister files' channels; InputError where it cannot be read."""
    record = read_record(path, unit=unit, layout=layout)
    # A path may be long: in a line that is cut off the unit stands before it.
    source = {"unit": record.unit, "format": record.format, "file": str(path)}
    source |= {key: " ".join(said.split()) for key, said in record.facts.items()}
    series = aligned(record)
    traces = tuple(
        _trace(channel.name, str(channel.orientation), series[channel.name], target) for channel in record.channels
    )
    return MotionInspection(path.name, source, traces, record.findings, target)


def inspect_component(motion: SceneMotion) -> MotionInspection:
    """One component of a scene as the models will feel it; InputError as `harness.input.motions.prepare`."""
    prepared = prepare(motion)
    excitation = prepared.excitation
    if isinstance(excitation, SampledAcceleration):
        steps = np.diff(excitation.t_s)
        dt_s = float(np.median(steps))
        if np.abs(steps - dt_s).max() <= 1e-6 * dt_s:
            series = Series(dt_s, excitation.samples_m_s2, prepared.done)
        else:  # a building's filter puts its samples where the ground has corners
            t_s = np.arange(0.0, excitation.end_s, dt_s)
            series = Series(dt_s, excitation.accel_m_s2(t_s), (*prepared.done, info("step_shown", dt_s=dt_s)))
    else:
        end = excitation.end_s if math.isfinite(excitation.end_s) else motion.duration_s or ENDLESS_S
        dt_s = min(_FINE_STEP_S, max(end, 1e-3) / _SAMPLES_PER_PERIOD)
        if (omega_rad_s := getattr(excitation, "omega_rad_s", 0.0)) > 0.0:
            dt_s = max(min(dt_s, 2.0 * math.pi / omega_rad_s / _SAMPLES_PER_PERIOD), end / _MOST_SAMPLES)
        # One that ends is followed past its end, one that the scene cuts off to where it does.
        count = math.ceil(end / dt_s) + 2 if math.isfinite(excitation.end_s) else math.floor(end / dt_s + 1e-9) + 1
        series = Series(dt_s, excitation.accel_m_s2(dt_s * np.arange(count)), prepared.done)
    kind, title = motion.component.kind, f"{motion.where}: {motion.key}"
    trace = _trace(motion.key, kind, series, prepared.target)
    return MotionInspection(title, {"kind": kind}, (trace,), prepared.findings, prepared.target)


def _trace(name: str, direction: str, series: Series, target: DesignSpectrum | None) -> Trace:
    if not np.abs(series.accel_m_s2).max() > 0.0:
        return Trace(name, direction, series, Measures(*(0.0,) * 10), np.zeros(PERIODS_S.size))
    damping = DAMPING if target is None else target.damping
    spectrum = spectrum_m_s2(series.accel_m_s2, series.dt_s, PERIODS_S, damping)
    return Trace(name, direction, series, measures(series), spectrum)


def in_g(accel_m_s2: Floats) -> Floats:
    """Acceleration in g."""
    return np.asarray(accel_m_s2 / STANDARD_GRAVITY_M_S2)
