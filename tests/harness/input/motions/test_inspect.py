"""The inspection of files and components: numbers, record, table, and a picture that shows them."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter

from harness.input.motions import SceneMotion
from harness.input.motions.inspect import PERIODS_S, inspect_component, inspect_file
from harness.input.motions.spec import Component, Target
from harness.input.motions.spectra import design_spectrum
from reports.export.figures import printed
from reports.export.motion_figure import WIDE, build_up_figure, histories_figure, motion_picture, spectrum_figure
from reports.messages import ENGLISH
from tests.harness.input.motions.writers import GRAVITY

ADAPTER: TypeAdapter[Any] = TypeAdapter(Component)


def test_a_file_is_shown_with_its_peaks_units_and_findings(data_dir: Path) -> None:
    found = inspect_file(data_dir / "records" / "20161113_110259_WTMC_20.V2A.gz")
    record = json.loads(json.dumps(found.record(ENGLISH.say)))
    assert [trace["name"] for trace in record["traces"]] == ["N28W", "S62W", "Up"]
    assert [round(trace["measures"]["pga_g"], 3) for trace in record["traces"]] == [0.992, 0.812, 1.838]
    assert record["source"]["unit"] == "mm/s2"
    assert record["source"]["format"] == "GeoNet V2A"
    assert record["warnings"] == [each["text"] for each in record["findings"]]
    assert {each["code"] for each in record["findings"]} == {"record_peak_time"}
    rows = {row[0]: row[1:] for row in found.table()}
    assert rows["pga_g"][0] == "0.9925"
    assert {len(row) for row in found.table()} == {4}


def test_the_picture_holds_every_trace_and_the_target(data_dir: Path) -> None:
    target = design_spectrum(Target(code="ec8", ag_g=0.3, soil="C", type=1))
    found = inspect_file(data_dir / "records" / "coalinga1983_PFZ14.csv", target=target)
    histories, spectrum = histories_figure(found), spectrum_figure(found)
    traces = histories["datasets"]["traces"]
    assert (len(histories["vconcat"]), len(traces)) == (3, 3)
    peaks = [np.abs(trace["accel"]).max() for trace in traces]
    assert max(peaks) == pytest.approx(0.27324, abs=1e-5)
    drawn = next(trace["y"] for trace in spectrum["datasets"]["spectra"] if trace["name"] == target.name)
    np.testing.assert_allclose(drawn, target.accel_m_s2(PERIODS_S) / GRAVITY)
    assert spectrum["encoding"]["y"]["scale"]["domain"][1] > 1.1 * max(drawn)
    shares = build_up_figure(found)["datasets"]["shares"]
    assert max(trace["share"][-1] for trace in shares) == pytest.approx(100.0)
    words = set(re.findall(r">([^<>\n]+)</text>", printed(motion_picture(found), WIDE)))
    assert {"acceleration  [g]", "velocity  [m/s]", "displacement  [m]", "period  [s]", target.name} <= words


@pytest.mark.parametrize(
    "keys",
    [
        {"kind": "rest"},
        {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 2.0},
        {"kind": "pulse", "shape": "rectangular", "amplitude_g": 0.3, "duration_s": 0.5},
        {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.3, "duration_s": 0.5, "floor": [{"period_s": 0.3}]},
        {"kind": "samples", "dt_s": 0.01, "accel_m_s2": [0.0, 1.5, -3.0, 2.0, 0.5, 0.0]},
    ],
)
def test_components_without_a_file(keys: dict[str, Any]) -> None:
    component = ADAPTER.validate_python(keys)
    found = inspect_component(SceneMotion(component, Path(), "scene.toml", "motion.x", 4.0))
    peak = found.traces[0].measures.pga_g
    assert peak == pytest.approx(0.0 if keys["kind"] == "rest" else 0.3, rel=1.5)
    charts = histories_figure(found), spectrum_figure(found), build_up_figure(found)
    parts = [part for chart in charts for parts in chart["datasets"].values() for part in parts]
    columns = [values for part in parts for key, values in part.items() if key != "name"]
    assert columns
    assert all(np.all(np.isfinite(values)) for values in columns)
    assert printed(motion_picture(found), WIDE).startswith("<?xml")
    json.dumps(found.record(ENGLISH.say))


@pytest.mark.parametrize(
    "keys",
    [
        {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 100.0},
        {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.3, "duration_s": 0.05, "start_s": 30.1},
    ],
)
def test_a_fast_component_is_shown_at_its_peak_and_as_strong_as_the_scene_makes_it(keys: dict[str, Any]) -> None:
    component = ADAPTER.validate_python(keys)
    found = inspect_component(SceneMotion(component, Path(), "scene.toml", "motion.x", 4.0, scale=2.0))
    # 400 samples in a period miss a crest by at most (2π/400)²/8.
    assert found.traces[0].measures.pga_g == pytest.approx(0.6, rel=1e-3)
    assert [(each.code, each.values["factor"]) for each in found.traces[0].series.done] == [("step_scaled", 2.0)]


def test_a_motion_without_end_is_inspected_to_where_the_scene_ends() -> None:
    """After whole periods the floor stands still; it was told to move, an instant past the end. 400 samples in a period follow
    the velocity 2A/ω to (2π/400)²/12."""
    component = ADAPTER.validate_python({"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 3.0})
    found = inspect_component(SceneMotion(component, Path(), "scene.toml", "motion.x", 4.0)).traces[0].measures
    assert found.end_velocity_m_s == pytest.approx(0.0, abs=1e-9)
    assert found.pgv_m_s == pytest.approx(2.0 * 0.3 * GRAVITY / (2.0 * np.pi * 3.0), rel=5e-5)
