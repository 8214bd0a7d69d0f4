"""From a scene's words to an excitation: kinds, files, the data folder, and every refusal with its key."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from analytic.excitation import Excitation, Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from harness.input.files import data_folder
from harness.input.mistakes import mistakes_of
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import Component, Motion
from harness.model import InputError
from tests.doubles import codes
from tests.harness.input.motions import writers
from tests.harness.input.motions.writers import GRAVITY, wave

ADAPTER: TypeAdapter[Any] = TypeAdapter(Component)


def made(base: Path = Path(), scene_s: float | None = None, **keys: Any) -> Excitation:
    component = ADAPTER.validate_python(keys)
    return prepare(SceneMotion(component, base, "scene.toml", "motion.x", scene_s)).excitation


def test_the_plain_kinds() -> None:
    assert made(kind="rest") == ZeroExcitation()
    harmonic = made(kind="harmonic", amplitude_g=0.3, frequency_hz=2.0, phase_deg=90.0, ramp_s=1.0)
    assert harmonic == Harmonic(0.3 * GRAVITY, 2.0, math.pi / 2.0, 1.0)
    pulse = made(kind="pulse", shape="ricker", amplitude_g=-0.3, duration_s=0.5, start_s=1.0)
    assert pulse == Pulse("ricker", -0.3 * GRAVITY, 0.5, 1.0)


def test_steps_are_taken_in_their_order_and_recorded(tmp_path: Path) -> None:
    writers.at2(tmp_path / "a.AT2", wave(1000), 0.01, "90")
    keys: dict[str, Any] = {
        "kind": "record", "file": "a.AT2", "column": "90", "window_s": [1.0, 9.0], "baseline": "linear",
        "bandpass_hz": [0.2, 20.0], "resample_dt_s": 0.005, "significant": [0.05, 0.95], "sign": -1, "pga_g": 0.4,
    }  # fmt: skip
    found = prepare(SceneMotion(ADAPTER.validate_python(keys), tmp_path, "scene.toml", "motion.x"))
    steps = ("read", "window", "baseline", "bandpass", "resampled", "significant", "scaled", "scaled")
    assert [step.code for step in found.done] == [f"step_{name}" for name in steps]
    assert [step.values["why"] for step in found.done[-2:]] == ["pga_g", "sign"]
    assert found.excitation.peak_m_s2 == pytest.approx(0.4 * GRAVITY, rel=1e-12)
    assert isinstance(found.excitation, SampledAcceleration)
    assert found.excitation.t_s[0] == 0.0
    assert "record_reader_untested" not in codes(found.findings)


def test_three_components_keep_one_clock_through_the_significant_duration(data_dir: Path) -> None:
    file = str(data_dir / "records" / "20161113_110259_WTMC_20.V2A.gz")
    whole = [made(kind="record", file=file, column=column) for column in ("N28W", "S62W", "up")]
    cut = [made(kind="record", file=file, column=column, significant=[0.05, 0.95]) for column in ("N28W", "S62W", "up")]
    assert len({motion.end_s for motion in cut}) == 1
    start = np.flatnonzero(whole[0].samples_m_s2 == cut[0].samples_m_s2[0])  # type: ignore[attr-defined]
    for before, after in zip(whole, cut, strict=True):
        n = after.samples_m_s2.size  # type: ignore[attr-defined]
        found = [i for i in start if np.array_equal(before.samples_m_s2[i : i + n], after.samples_m_s2)]  # type: ignore[attr-defined]
        assert len(found) == 1


def test_the_data_folder_is_expanded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    writers.at2(tmp_path / "a.AT2", wave(), 0.01, "90")
    monkeypatch.setenv("ROCKCHECK_DATA", str(tmp_path))
    assert made(kind="record", file="${ROCKCHECK_DATA}/a.AT2").peak_m_s2 == pytest.approx(2.0, abs=1e-6)
    monkeypatch.delenv("ROCKCHECK_DATA")
    assert data_folder().parts[-2:] == ("shared", "data")


@pytest.mark.parametrize(
    ("keys", "key", "said"),
    [
        ({"file": "none.csv"}, "motion.x.file", "an existing file"),
        ({"file": "$HOME/none.csv"}, "motion.x.file", "write it out"),
        ({"file": "a.csv"}, "motion.x.column", "a_N28W_ms2 (azimuth 332°), a_UP_ms2 (up)"),
        ({"file": "a.csv", "column": "EW"}, "motion.x.column", "wanted one of a_N28W_ms2"),
        ({"file": "a.csv", "azimuth_deg": 0.0}, "motion.x.azimuth_deg", "two horizontal channels"),
        ({"file": "a.csv", "column": "UP", "window_s": [50.0, 60.0]}, "motion.x.window_s", "nothing is left"),
        ({"file": "a.csv", "column": "UP", "bandpass_hz": [0.1, 60.0]}, "motion.x.bandpass_hz", "below 50 Hz"),
    ],
)
def test_refusals_name_their_key(tmp_path: Path, keys: dict[str, Any], key: str, said: str) -> None:
    table = np.column_stack([0.01 * np.arange(200), wave(), wave(phase=1.0)])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t_s,a_N28W_ms2,a_UP_ms2", comments="")
    with pytest.raises(InputError) as error:
        made(tmp_path, kind="record", **keys)
    assert [(mistake.where, mistake.key) for mistake in error.value.mistakes] == [("scene.toml", key)]
    assert said in str(error.value)


SITE: dict[str, Any] = {"kind": "spectrum", "code": "ec8", "ag_g": 0.2, "soil": "A", "type": 1}


@pytest.mark.parametrize(
    ("key", "keys"),
    [
        ("pga_g", {"kind": "record", "file": "a", "scale": 2.0, "pga_g": 1.0}),
        ("azimuth_deg", {"kind": "record", "file": "a", "column": "x", "azimuth_deg": 30.0}),
        ("window_s", {"kind": "record", "file": "a", "window_s": [5.0, 5.0]}),
        ("significant", {"kind": "record", "file": "a", "significant": [0.95, 0.05]}),
        ("bandpass_hz", {"kind": "record", "file": "a", "bandpass_hz": [0.0, 5.0]}),
        ("scale", {"kind": "record", "file": "a", "scale": 0.0}),
        ("speed", {"kind": "record", "file": "a", "speed": 1.0}),
        ("amplitude_g", {"kind": "harmonic", "amplitude_g": "3", "frequency_hz": 1.0}),
        ("amplitude_g", {"kind": "harmonic", "amplitude_g": math.nan, "frequency_hz": 1.0}),
        ("seed", SITE),
        ("code", {**SITE, "seed": 1, "S": 1.2}),
        ("TC_s", {"kind": "spectrum", "code": "ec8", "ag_g": 0.2, "S": 1.0, "TB_s": 0.5, "TC_s": 0.4, "TD_s": 2.0, "seed": 1}),
        ("method", {**SITE, "seed": 1, "method": "scale"}),
        ("seed", {**SITE, "seed": 1, "record": {"file": "a"}}),
        ("duration_s", {**SITE, "duration_s": 20.0, "record": {"file": "a"}}),
        ("floor.0.period_s", {"kind": "harmonic", "amplitude_g": 0.1, "frequency_hz": 1.0, "floor": [{"period_s": 0.0}]}),
    ],
)  # fmt: skip
def test_contradictions_are_refused_by_their_key_before_any_file_is_opened(key: str, keys: dict[str, Any]) -> None:
    with pytest.raises(ValidationError) as error:
        Motion(x=keys)  # type: ignore[arg-type]
    (mistake,) = mistakes_of(error.value, Motion, "a scene")
    assert mistake.key == f"x.{key}"


def test_an_endless_motion_through_a_building_needs_the_scenes_duration() -> None:
    keys: dict[str, Any] = {"kind": "harmonic", "amplitude_g": 0.1, "frequency_hz": 1.0, "floor": [{"period_s": 0.5}]}
    with pytest.raises(InputError, match=r": motion\.x\.floor: .* duration_s"):
        made(**keys)
    assert made(scene_s=3.0, **keys).end_s == 3.0


def test_a_floor_has_no_ground_target() -> None:
    keys: dict[str, Any] = {
        "kind": "spectrum",
        "code": "ec8",
        "ag_g": 0.2,
        "soil": "A",
        "type": 2,
        "seed": 4,
        "duration_s": 5.0,
    }
    ground, floor = (
        prepare(SceneMotion(ADAPTER.validate_python({**keys, **more}), Path(), "s", "motion.x"))
        for more in ({}, {"floor": [{"period_s": 0.3, "damping": 0.1}]})
    )
    assert ground.target is not None
    assert floor.target is None
    assert floor.excitation.peak_m_s2 > ground.excitation.peak_m_s2
    assert floor.excitation.end_s > ground.excitation.end_s
