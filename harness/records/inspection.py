"""The record of `rockcheck motion inspect`: everything but the histories."""

from __future__ import annotations

from dataclasses import asdict

from harness.input.motions.inspect import DAMPING, PERIODS_S, MotionInspection
from harness.model.finding import Say, texted
from harness.model.run import SCHEMA_VERSION, to_plain
from harness.records.base import Plain


def inspection_record(inspection: MotionInspection, say: Say) -> Plain:
    """An inspected motion as plain values, its findings and what was done to it said by `say`.

    Of each channel its samples, what was done to it, its measures and its pseudo-acceleration spectrum; of a design spectrum that
    the motion was to follow its value at the same periods.
    """
    target, findings = inspection.target, texted(inspection.findings, say)
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
        for trace in inspection.traces
    ]
    record: Plain = to_plain(
        {
            "schema_version": SCHEMA_VERSION,
            "title": inspection.title,
            "source": inspection.source,
            "damping": DAMPING if target is None else target.damping,
            "periods_s": PERIODS_S,
            "traces": traces,
            "target": target and {**asdict(target), "spectrum_m_s2": target.accel_m_s2(PERIODS_S)},
            "warnings": [each.text for each in findings],
            "findings": findings,
        }
    )
    return record
