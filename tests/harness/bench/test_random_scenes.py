"""The command that counts statements that hold and verdicts that do not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from harness.bench import random_scenes
from harness.bench.random_scenes import BEGIN, END, GENERATORS, measured, renewed, row_of, tables


def test_a_row_holds_each_engine_s_statement_and_each_pair_s_verdict() -> None:
    row = row_of("random", 20_900)
    for name, item in row["engines"].items():
        assert item["rotation_holds"] == (item["error_rad"] <= item["stated_rad"]), name
        assert item["slip_holds"] == (item["error_m"] <= item["stated_m"]), name
        assert 0.0 <= item["share"] <= 1.0
    assert len(row["pairs"]) == 3
    assert all(pair["refuted"] is None or pair["verdict"] == "differ: model" for pair in row["pairs"].values())


def test_generators_are_reproducible_and_differ() -> None:
    for name, make in GENERATORS.items():
        a, b, other = make(5), make(5), make(6)
        assert a.statue.mass_kg == b.statue.mass_kg != other.statue.mass_kg, name
    assert len({make(5).base_excitation.x.peak_m_s2 for make in GENERATORS.values()}) == 3


def told(generator: str, seed: int, **changes: Any) -> dict[str, Any]:
    item = {"rotation_holds": True, "slip_holds": True, "share": 1.0, "runs": 3} | changes
    pair = {"verdict": "differ: model", "sentence": "", "refuted": changes.get("rotation_holds") is False}
    return {"generator": generator, "seed": seed, "engines": {"pymunk": item}, "pairs": {"a_vs_b": pair}}


def test_tables_count_what_held_and_what_is_refuted() -> None:
    table = tables([told("random", 1), told("random", 2, rotation_holds=False, share=0.5), told("wide", 1)])
    assert "| random | `pymunk` | 2 | 1 (50 %) | 2 (100 %) | 75 % | 3 |" in table
    assert "| random | 2 | 0 | 2 | 0 | 0 | 0 | 0 | 1 |" in table
    assert "| wide | 1 | 0 | 1 | 0 | 0 | 0 | 0 | 0 |" in table


def test_what_is_measured_is_kept_and_rows_of_other_code_are_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, int]] = []

    def row(generator: str, seed: int) -> dict[str, Any]:
        asked.append((generator, seed))
        return told(generator, seed)

    monkeypatch.setattr(random_scenes, "row_of", row)
    path = tmp_path / "rows.jsonl"
    assert len(measured(path, range(2))) == len(asked) == 6
    assert len(measured(path, range(3))) == 9
    assert len(asked) == 9
    monkeypatch.setattr(random_scenes, "source", lambda: "other code")
    assert len(measured(path, range(1))) == 3
    assert len(asked) == 12


def test_only_what_stands_between_the_marks_is_renewed() -> None:
    page = f"before\n{BEGIN}\nold\n{END}\nafter\n"
    assert renewed(page, "new", 3, 10) == (
        f"before\n{BEGIN}\nSeeds 10 to 12 of each generator, target 1e-3 rad:\n\nnew\n{END}\nafter\n"
    )
    with pytest.raises(ValueError, match="no marks"):
        renewed("a page", "new", 3, 10)
