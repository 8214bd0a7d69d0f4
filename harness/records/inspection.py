"""The record of `rockcheck motion inspect`: everything but the histories."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

from harness.input.motions.inspect import DAMPING, PERIODS_S, Inspection, Trace
from harness.input.motions.spectra import DesignSpectrum, Measures
from harness.model.finding import Finding, Say, texted
from harness.model.run import OMITTED, SCHEMA_VERSION


@dataclass(frozen=True, kw_only=True)
class TraceRecord:
    """One channel: its samples, what was done to it, its measures and its pseudo-acceleration spectrum."""

    name: str
    direction: str
    dt_s: float
    samples: int
    done: Sequence[str]
    measures: Measures
    spectrum_m_s2: Sequence[float]

    @classmethod
    def of(cls, trace: Trace, say: Say) -> TraceRecord:
        """The record of a channel, its steps said by `say`."""
        return cls(
            name=trace.name,
            direction=trace.direction,
            dt_s=trace.series.dt_s,
            samples=int(trace.series.accel_m_s2.size),
            done=[say(step) for step in trace.series.done],
            measures=trace.measures,
            spectrum_m_s2=trace.spectrum_m_s2.tolist(),
        )


@dataclass(frozen=True, kw_only=True)
class TargetRecord(DesignSpectrum):
    """The design spectrum that a motion was to follow, at the periods of the record."""

    spectrum_m_s2: Sequence[float]


@dataclass(frozen=True, kw_only=True)
class InspectionRecord:
    """Channels on one clock with where they came from; `files` lists the picture beside the record."""

    schema_version: int = SCHEMA_VERSION
    title: str
    source: Mapping[str, str]
    damping: float
    periods_s: Sequence[float]
    traces: Sequence[TraceRecord]
    target: TargetRecord | None
    warnings: Sequence[str]
    findings: Sequence[Finding]
    files: Mapping[str, str | None] | None = field(default=None, metadata=OMITTED)

    @classmethod
    def of(cls, inspection: Inspection, say: Say) -> InspectionRecord:
        """The record of an inspected motion, its findings said by `say`."""
        target, findings = inspection.target, texted(inspection.findings, say)
        return cls(
            title=inspection.title,
            source=inspection.source,
            damping=DAMPING if target is None else target.damping,
            periods_s=PERIODS_S.tolist(),
            traces=[TraceRecord.of(trace, say) for trace in inspection.traces],
            target=None
            if target is None
            else TargetRecord(**asdict(target), spectrum_m_s2=target.accel_m_s2(PERIODS_S).tolist()),
            warnings=[each.text for each in findings],
            findings=findings,
        )
