"""Every valid scene has its pages, and a page that cannot be written costs neither another page nor the answer."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from harness.input.scene_file import load_scene
from harness.questions.scene.scene_run import run_scene, write_result
from reports.cli import app
from reports.pages.page import write_report
from tests.reports.claim_scenes import content, write_scene

ODD: Mapping[str, Mapping[str, Any]] = {
    "a pedestal without friction": {"contact": {"floor_static": 0.0, "floor_kinetic": 0.0, "statue": 1.0}},
    "fifty times gravity": {"motion": {"x": {"kind": "harmonic", "amplitude_g": 50.0, "frequency_hz": 2.0}}},
    "a centroid at a millimetre": {
        "statue": {
            "mass_kg": 300.0, "centroid_height_m": 0.001, "corner_left_m": 0.2, "corner_right_m": 0.15, "inertia_kg_m2": 10.0,
            "height_m": 0.002, "depth_m": 0.5,
        }
    },
    **{f"let go from {start} rad": {"initial": {"theta_rad": start}} for start in (0.5, 0.8, 1.2, 1.49, -1.2)},
}  # fmt: skip
"""Valid scenes far from any museum: each has its pages."""


@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("pedestal", [True, False])
def test_every_valid_scene_has_its_pages(tmp_path: Path, name: str, pedestal: bool) -> None:
    scene = content(7) | {"title": name, "motion": {"x": {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 2.0}}}
    scene = scene | {"contact": {"floor_static": 0.3, "floor_kinetic": 0.3, "statue": 1.0}} | ODD[name]
    if not pedestal:
        del scene["pedestal"]
    write_result(run_scene(load_scene(write_scene(tmp_path, scene)), ["analytic"]), tmp_path / "out")
    write_report(tmp_path / "out")
    assert f"<h1>{name}</h1>" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert f"<h1>{name}</h1>" in (tmp_path / "out" / "conservator.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("page", "other"), [("run_page.run_page", "conservator.html"), ("conservator.blocks", "report.html")]
)
def test_a_page_that_fails_costs_no_other_and_no_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, page: str, other: str
) -> None:
    """Whatever a page trips over, the other page, the summary and the result are there, and the failure has a name."""
    scene = write_scene(tmp_path, content(1))

    def trip(*_: Any) -> None:
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr(f"reports.pages.{page}", trip)
    result = CliRunner().invoke(app, ["run", str(scene), "-e", "analytic", "--out", str(tmp_path / "out")])
    assert result.exit_code == 1
    assert "analytic" in result.stdout
    failed = "report.html" if other == "conservator.html" else "conservator.html"
    assert re.search(f"{failed} .*ZeroDivisionError", result.stderr)
    assert "fault of rockcheck" in result.stderr
    assert (tmp_path / "out" / other).is_file()
    assert not (tmp_path / "out" / failed).exists()
