"""A real scan under two real records, posed twelve times: fitted on one share, scored on the other, shown on a page."""

from pathlib import Path

from harness.comparison.statistics import FELL
from harness.questions.validate.scenes import read_table
from reports.pages.page import write_report
from tests.harness.questions.validate.experiments import seen, validate, write_table

RECORDS = (
    ("coalinga1983_PFZ14.csv", "a_90_ms2", "a_UP_ms2", (2, 2.5, 3, 3.5, 4, 5)),
    ("kaikoura2016_WTMC.csv", "a_N28W_ms2", "a_Up_ms2", (0.5, 0.6, 0.7, 0.8, 0.9, 1)),
)
"""File, channel along the rocking plane, vertical channel, factors that take the scan from rest to its fall."""
POSES_DEG = (0, 45, 90)
TRUE_POSE = 2


def write_posed(folder: Path, data_dir: Path) -> Path:
    """Twelve tests of the scan in a pose that is not known, observed as the model has it in the last of three."""
    rows = []
    for name, along, up, scales in RECORDS:
        for scale in scales:
            row = {
                "test": f"{name[:4]}{scale:g}",
                "mesh": str(data_dir / "meshes" / "maria_acephalous.obj"),
                "unit": "m",
            }
            row |= {"motion": str(data_dir / "records" / name), "column": along, "column_z": up, "motion_unit": "m/s2"}
            row |= {"scale": str(scale), "friction": "0.7", "azimuth_deg": ";".join(map(str, POSES_DEG))}
            rows.append(row | {"observed": "stands", "share": "fit" if len(rows) % 2 else "rest"})
    path = write_table(folder / "posed.csv", rows)
    for row, trial in zip(rows, read_table(path), strict=True):
        true = seen(trial, azimuth_deg=float(POSES_DEG[TRUE_POSE]))
        row["observed"] = FELL if true.overturned else "stands"
    return write_table(path, rows)


def test_a_real_scan_is_fitted_scored_and_shown(tmp_path: Path, data_dir: Path) -> None:
    found = validate(write_posed(tmp_path, data_dir), tmp_path / "out", models=["analytic"], jobs=1, quiet=True)
    model = found["models"]["analytic"]
    for share in ("fit", "rest"):
        assert {row["observed"] for row in found["rows"] if row["share"] == share} == {"stands", FELL}
    assert model["failed"] == 0
    assert model["fitted"]["tests"] == model["tests"] == 6
    assert [each["value"] for each in model["fitted"]["inputs"]] == [float(POSES_DEG[TRUE_POSE])]
    assert model["outcomes"]["precision"]["value"] == model["outcomes"]["recall"]["value"] == 1.0
    page = write_report(tmp_path / "out").read_text(encoding="utf-8")
    assert "maria_acephalous.obj" in page
    assert all(row["test"] in page for row in found["rows"])
