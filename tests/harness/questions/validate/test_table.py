"""The table of experiments: what it says, and every mistake at once with its row and column."""

import csv
import re
from pathlib import Path

import pytest

from harness.model import InputError
from harness.questions.validate.scenes import COLUMNS, Inputs, read_table
from tests.harness.questions.validate.experiments import read_rows, write_experiments, write_table


def test_a_table_is_read_with_its_defaults(tmp_path: Path) -> None:
    trials = read_table(write_experiments(tmp_path, [2.0, 4.0], azimuth_deg="0;45;90", share="fit"))
    assert [trial.name for trial in trials] == ["t0", "t1"]
    first = trials[0]
    assert first.unknown == {"azimuth_deg": (0.0, 45.0, 90.0)}
    assert first.inputs().friction is None
    assert first.mesh == (tmp_path / "stone.ply").resolve()
    assert (first.unit, first.up, first.inputs().sign, first.inputs().scale) == ("m", "z", 1, 1.0)
    assert first.share == "fit"
    assert not first.fell


def test_comments_and_a_byte_order_mark_are_skipped(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, [2.0])
    path.write_text("\ufeff# tests of May\n" + path.read_text(), encoding="utf-8")
    with pytest.raises(InputError, match="column test"):
        # The mark belongs to the first line, a comment here; a header below it is read.
        read_table(write_table(tmp_path / "other.csv", [{"observed": "stands", "mesh": "stone.ply"}]))
    assert len(read_table(path)) == 1


def test_all_mistakes_come_at_once_with_their_place(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, [2.0, 3.0, 4.0])
    lines = path.read_text().splitlines()
    lines[1] = lines[1].replace("stands", "stand")
    lines[2] = lines[2].replace("burst1.csv", "lost.csv").replace("t1", "t0")
    lines[3] = lines[3].replace("m/s2", "gal") + ",7"
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError) as caught:
        read_table(path)
    told = str(caught.value)
    assert "row 1: observed: " in told
    assert " stands?" in told
    assert "lost.csv" in told
    assert "row 3: motion_unit" in told
    assert re.search(r"row 3: wanted (7 .* 8|6 .* 7)$", told, re.M)
    assert re.search("row 2: test: .* 't0', .* 1$", told, re.M)


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        ({"azimuth": "3"}, "did you mean azimuth_deg"),
        ({"friction": "0.5;-1"}, "above 0"),
        ({"azimuth_deg": "north"}, "a finite number"),
        ({"sign": "2"}, "one of 1, -1"),
        ({"mass_kg": "1;2"}, "one number"),
        ({"scene": "stone.ply"}, "either a scene or a mesh"),
        ({"bandpass_hz": "20;0.2"}, "two frequencies, low;high"),
        ({"bandpass_hz": "0.2;20|5"}, "two frequencies, low;high"),
        ({"bandpass_hz": "20"}, "two frequencies, low;high"),
        ({"baseline": "parabola"}, "one of none, mean"),
        ({"observed": "2"}, "one of 0, 1, overturned, stands"),
    ],
)
def test_a_wrong_cell_is_told(tmp_path: Path, columns: dict[str, str], says: str) -> None:
    with pytest.raises(InputError, match=says):
        read_table(write_experiments(tmp_path, [2.0], **columns))


@pytest.mark.parametrize(
    ("cells", "says"),
    [
        ({"density_kg_m3": "2000", "up": "y"}, "scene: wanted up and density_kg_m3 of a mesh, got a scene"),
        ({"mass_kg": "30"}, "scene: wanted mass_kg of a mesh"),
        ({"column": "table", "motion_unit": "g"}, "motion: wanted column and motion_unit of a file"),
        ({"baseline": "linear"}, "motion: wanted baseline of a file"),
    ],
)
def test_what_says_nothing_of_a_scene_is_refused(tmp_path: Path, cells: dict[str, str], says: str) -> None:
    (tmp_path / "block.toml").write_text("")
    row = {"test": "a", "scene": "block.toml", "observed": "stands", **cells}
    with pytest.raises(InputError, match=says):
        read_table(write_table(tmp_path / "table.csv", [row]))


def test_outcomes_may_be_numbers_and_motions_are_treated(tmp_path: Path) -> None:
    path = write_experiments(
        tmp_path, [2.0], observed="1", mass_kg="12.5", baseline="linear", bandpass_hz="0.2;20", inset_m="0;0.002"
    )
    first = read_table(path)[0]
    assert first.fell
    assert first.observed == "overturned"
    assert (first.mass_kg, first.inputs().baseline, first.inputs().bandpass_hz) == (12.5, "linear", (0.2, 20.0))
    assert first.unknown == {"inset_m": (0.0, 0.002)}
    assert not read_table(write_experiments(tmp_path, [2.0], observed="0"))[0].fell


@pytest.mark.parametrize("mark", [";", "\t"])
def test_a_table_may_be_parted_by_semicolons_and_have_decimal_commas(tmp_path: Path, mark: str) -> None:
    path = write_experiments(tmp_path, [2.0], azimuth_deg="0;22.5", mass_kg="12.5")
    rows = list(csv.reader(path.read_text().splitlines()))
    said = "\n".join(mark.join(f'"{cell.replace(".5", ",5")}"' for cell in row) for row in rows)
    other = tmp_path / "excel.csv"
    other.write_text("\ufeff" + said, encoding="utf-8")
    assert read_table(other) == read_table(path)


def test_every_input_of_a_test_may_be_a_list_each_body_s_own(tmp_path: Path) -> None:
    path = write_experiments(
        tmp_path, [2.0], sign="1;-1", scale="0.9;1;1.1", baseline="none;linear", bandpass_hz="none|0.2;20|0.5;30"
    )
    first = read_table(path)[0]
    assert first.unknown == {
        "sign": (1, -1),
        "scale": (0.9, 1.0, 1.1),
        "baseline": ("none", "linear"),
        "bandpass_hz": (None, (0.2, 20.0), (0.5, 30.0)),
    }
    assert first.inputs() == Inputs(scale=0.9)
    rows = read_rows(path)
    (tmp_path / "other.ply").write_bytes((tmp_path / "stone.ply").read_bytes())
    rows.append(rows[0] | {"test": "t1", "mesh": "other.ply", "scale": "0.5;0.6"})
    assert [trial.unknown["scale"] for trial in read_table(write_table(path, rows))] == [(0.9, 1.0, 1.1), (0.5, 0.6)]


def test_unknown_inputs_share_one_list(tmp_path: Path) -> None:
    path = write_experiments(tmp_path, [2.0, 3.0], friction="0.3;0.6")
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:2], lines[2].replace("0.3;0.6", "0.4;0.6")]) + "\n")
    with pytest.raises(InputError, match=r": friction: .*stone\.ply.* got 2 "):
        read_table(path)


@pytest.mark.parametrize("text", ["", "test,observed,mesh\n"])
def test_an_empty_table_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "empty.csv").write_text(text)
    with pytest.raises(InputError, match=r"empty\.csv: wanted "):
        read_table(tmp_path / "empty.csv")


def test_every_column_is_documented(root: Path) -> None:
    text = (root / "docs" / "scores.md").read_text(encoding="utf-8")
    assert [name for name in COLUMNS if f"`{name}`" not in text] == []
