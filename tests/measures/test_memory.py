"""Memory that a run keeps and creep at rest, as `python -m tests.measures.memory` measures them."""

from __future__ import annotations

import pytest

from harness import engines
from harness.engines.base import Engine, Settings
from harness.engines.pymunk import Munk2D
from harness.model.run import Run, RunOptions
from harness.model.scene import Scene
from tests import budgets_engines as budget
from tests.measures import memory


class Keeps(Engine):
    """An engine that keeps something of every run."""

    name = "keeps"
    capabilities = Munk2D.capabilities
    order = 1.0

    def __init__(self) -> None:
        self.own = Munk2D()
        self.kept: list[bytearray] = []

    def missing(self) -> None:
        return None

    def refinement_levels(self, scene: Scene) -> tuple[Settings, ...]:
        return self.own.refinement_levels(scene)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> Settings:
        return self.own.settings_for_dt(scene, dt_s)

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[Settings, ...]:
        return self.own.verification_settings(scene, settings)

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        self.kept.append(bytearray(b"x" * 2**22))
        return self.own.simulate(scene, settings, options)


def test_three_hundred_runs_of_pymunk_keep_nothing() -> None:
    row = memory.memory(engines.load("pymunk"), (100, 400))
    assert row["kib_a_run"] <= budget.KEPT_OF_MANY_KIB


def test_what_an_engine_keeps_is_seen() -> None:
    # 4 MiB a run: earlier tests of the process may have freed some 80 MiB for reuse, as once seen.
    assert memory.memory(Keeps(), (20, 120))["kib_a_run"] >= 512.0


def test_pymunk_keeps_its_place_at_rest_on_every_level(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "MOST_STEPS", 300)
    rows = list(memory.creep(engines.load("pymunk")))
    assert {row["pedestal"] for row in rows} == {False, True}
    assert max(row["creep_m"] for row in rows) <= budget.CREEP
    assert max(row["creep_rad"] for row in rows) <= budget.CREEP_TURN_RAD
