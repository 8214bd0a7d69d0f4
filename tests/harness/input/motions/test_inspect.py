"""The inspection of files and components: numbers, record, table, and a picture that shows them."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from harness.input.motions.inspect import PERIODS_S, inspect_component, inspect_file
from harness.input.motions.spec import Component, Target
from harness.input.motions.spectra import design_spectrum
from harness.model.run import to_plain
from harness.records.inspection import InspectionRecord
from reports.export.motion_figure import _outline, figure
from tests.harness.input.motions.writers import GRAVITY

ADAPTER: TypeAdapter[Any] = TypeAdapter(Component)


def test_a_file_is_shown_with_its_peaks_units_and_findings(data_dir: Path) -> None:
    found = inspect_file(data_dir / "records" / "20161113_110259_WTMC_20.V2A.gz")
    record = json.loads(json.dumps(to_plain(InspectionRecord.of(found))))
    assert [trace["name"] for trace in record["traces"]] == ["N28W", "S62W", "Up"]
    assert [round(trace["measures"]["pga_g"], 3) for trace in record["traces"]] == [0.992, 0.812, 1.838]
    assert record["source"]["unit"] == "mm/s2"
    assert "tried on originals" in record["source"]["format"]
    assert len(record["warnings"]) == 3
    rows = {row[0]: row[1:] for row in found.table()}
    assert rows["PGA"][:2] == ("g", "0.9925")
    assert {len(row) for row in found.table()} == {5}


def test_the_picture_holds_every_trace_and_the_target(data_dir: Path) -> None:
    target = design_spectrum(Target(code="ec8", ag_g=0.3, soil="C", type=1))
    found = inspect_file(data_dir / "records" / "coalinga1983_PFZ14.csv", target=target)
    drawing = figure(found)
    acceleration, velocity, displacement, spectrum, build_up = drawing.axes
    for axis in (acceleration, velocity, displacement):
        assert len(axis.lines) == 4  # three traces and the zero line
    assert max(np.abs(line.get_ydata()).max() for line in acceleration.lines) == pytest.approx(0.27324, abs=1e-5)
    drawn = spectrum.lines[0].get_ydata()
    np.testing.assert_allclose(drawn, target.accel_m_s2(PERIODS_S) / GRAVITY)
    assert spectrum.get_ylim()[1] > 1.1 * drawn.max()
    assert max(line.get_ydata()[-1] for line in build_up.lines[:3]) == pytest.approx(100.0)
    page = io.BytesIO()
    drawing.savefig(page, format="svg")
    assert page.getvalue().startswith(b"<?xml")


def test_thinning_keeps_every_peak() -> None:
    accel = np.random.default_rng(2).normal(size=50_001)
    kept = _outline(accel)
    assert kept.size < 5_000
    assert {int(np.argmax(accel)), int(np.argmin(accel)), 0, 50_000} <= set(kept.tolist())


@pytest.mark.parametrize(
    "keys",
    [
        {"kind": "rest"},
        {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 2.0},
        {"kind": "pulse", "shape": "rectangular", "amplitude_g": 0.3, "duration_s": 0.5},
        {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.3, "duration_s": 0.5, "floor": [{"period_s": 0.3}]},
    ],
)
def test_components_without_a_file(keys: dict[str, Any]) -> None:
    component = ADAPTER.validate_python(keys)
    found = inspect_component(component, base_dir=Path(), where="scene.toml", key="motion.x", duration_s=4.0)
    peak = found.traces[0].measures.pga_g
    assert peak == pytest.approx(0.0 if keys["kind"] == "rest" else 0.3, rel=1.5)
    assert len(figure(found).axes) == 5
    json.dumps(to_plain(InspectionRecord.of(found)))
