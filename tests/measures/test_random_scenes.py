"""The command that counts statements that hold and verdicts that do not."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from harness.records.bench import Statement
from harness.records.scores import Verdict
from tests.engines_for_tests import ready
from tests.measures import seeded_rows
from tests.measures.random_scenes import Judged, SceneRow, row_of, tables
from tests.measures.seeded_rows import measured
from tests.measures.seeded_scenes import GENERATORS


def test_a_row_holds_each_engine_s_statement_and_each_pair_s_verdict() -> None:
    ready("pybullet")
    row = row_of("random", 20_900)
    for name, item in row.engines.items():
        assert item.engine == name
        assert item.rotation_holds == (item.error_rad <= item.stated_rad), name
        assert item.slip_holds == (item.error_m <= item.stated_m), name
        assert 0.0 < item.share <= 1.0
    assert len(row.pairs) == 3
    assert all(pair.refuted is None or pair.verdict == "differ: model" for pair in row.pairs.values())


def test_generators_are_reproducible_and_differ() -> None:
    for name, make in GENERATORS.items():
        a, b, other = make(5), make(5), make(6)
        assert a.statue.mass_kg == b.statue.mass_kg != other.statue.mass_kg, name
    assert len({make(5).base_excitation.x.peak_m_s2 for make in GENERATORS.values()}) == 3


def told(generator: str, seed: int, error_rad: float = 0.0, until_s: float = 2.0) -> SceneRow:
    stated = Statement("pymunk", "stands", 1e-3, 3, 9000, 1e-4, 1e-5, until_s, 2.0, error_rad, 0.0)
    pair = Judged("differ: model", "", refuted=error_rad > 0.0)
    return SceneRow(generator, seed, {"pymunk": stated}, {"a_vs_b": pair})


def test_tables_count_what_held_and_what_is_refuted() -> None:
    table = tables([told("random", 1), told("random", 2, 1.0, until_s=1.0), told("wide", 1)])
    assert "| random | `pymunk` | 2 | 1 (50 %) | 2 (100 %) | 75 % | 3 |" in table
    none = " 0 |" * (len(Verdict) - 2)
    assert list(Verdict)[:2] == [Verdict.AGREE, Verdict.MODEL]
    assert f"| random | 2 | 0 | 2 |{none} 1 |" in table
    assert f"| wide | 1 | 0 | 1 |{none} 0 |" in table


def test_what_is_measured_is_kept_and_rows_of_other_code_are_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[str, int]] = []

    def row(generator: str, seed: int) -> SceneRow:
        asked.append((generator, seed))
        return told(generator, seed, error_rad=math.inf)

    path = tmp_path / "rows.jsonl"
    keys = [(generator, seed) for seed in range(3) for generator in GENERATORS]
    first = measured(path, SceneRow, keys[:6], row)
    assert [item.key for item in first] == asked == keys[:6]
    assert measured(path, SceneRow, keys, row)[:6] == first
    assert asked == keys
    monkeypatch.setattr(seeded_rows, "source", lambda: "other code")
    assert len(measured(path, SceneRow, keys[:1], row)) == 1
    assert len(asked) == 10


def test_the_command_line_asks_for_seeds_and_a_file() -> None:
    words = seeded_rows.command_line("tests.measures.random_scenes", None, 100, 710_000)
    assert seeded_rows.seeds_of(words.parse_args([])) == range(710_000, 710_100)
    given = words.parse_args(["2", "5"])
    assert (seeded_rows.seeds_of(given), given.out.name) == (range(5, 7), "random_scenes.jsonl")
