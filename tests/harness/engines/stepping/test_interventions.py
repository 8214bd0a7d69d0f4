"""What is written to an engine's bodies goes through one place, is accounted for, and is no more than the steps explain."""

import ast
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from harness import Run, RunOptions, Scene, engines
from harness.engines.base import LayerFault
from harness.engines.stepping.step_state import RowWriter
from harness.engines.stepping.trajectory import Account, Ledger
from harness.records import base
from tests import budgets_engines as budget
from tests.engines_for_tests import ready
from tests.measures.coverage import random_scene
from tests.scenes_for_tests import paestum

PLACES = {
    "pymunk": {"backend.py", "world.py"},
    "pybullet": {"world.py"},
}
"""Modules that may write to a body: pymunk's `world` before the start."""
CALLS = ("cpBodySet", "cpBodyApply", "cpBodyUpdate", "resetBase", "applyExternal", "resetJoint")
PROPERTIES = {"position", "angle", "velocity", "angular_velocity"}


def writes(source: str) -> set[str]:
    """Functions in which a body is written to, by their names; `""` for what is written in none."""
    found: set[str] = set()

    def look(node: ast.AST, within: str) -> None:
        if isinstance(node, ast.FunctionDef):
            within = node.name
        if isinstance(node, ast.Attribute) and node.attr.startswith(CALLS):
            found.add(within)
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AugAssign) else []
        )
        for target in targets:
            for part in ast.walk(target):
                if (
                    isinstance(part, ast.Attribute)
                    and part.attr in PROPERTIES
                    and isinstance(part.ctx, ast.Store | ast.Load)
                ):
                    found.add(within)
        for child in ast.iter_child_nodes(node):
            look(child, within)

    look(ast.parse(source), "")
    return found


@pytest.mark.parametrize("name", list(PLACES))
def test_bodies_are_written_to_in_one_place(root: Path, name: str) -> None:
    found = {
        path.name: writes(path.read_text(encoding="utf-8")) for path in (root / "harness/engines" / name).glob("*.py")
    }
    assert {module for module, functions in found.items() if functions} == PLACES[name]
    if name == "pymunk":
        assert found["world.py"] == {"_pedestal", "_statue", "_throw"}, "the start alone"


def test_a_write_elsewhere_is_seen() -> None:
    assert writes("def f(body):\n    body.velocity = (0, 0)\n") == {"f"}
    assert writes("def f(lib):\n    lib.cpBodySetAngle(1)\n") == {"f"}
    assert writes("def f(body):\n    body.velocity[:2] = 0\n") == {"f"}
    assert writes("def f(pybullet):\n    pybullet.resetBaseVelocity(1)\n") == {"f"}
    assert writes("def f(body):\n    return body.velocity\n") == set()


@pytest.mark.parametrize("name", list(engines.REGISTRY))
def test_the_record_tells_what_was_written(name: str) -> None:
    engine = ready(name)
    scene = paestum(0.429, 3.0, mu=(0.20, 0.15), pedestal=engine.capabilities.pedestal)
    run = engine.simulate(scene, engine.settings_for_dt(scene, 1e-3), RunOptions())
    record = base.plain(run)
    assert base.part(Run, record, Path("store")).interventions == run.interventions
    if name in ("analytic", "spatial") or name.endswith(":plain"):
        assert not run.interventions
        return
    assert run.interventions["friction_release"].steps_again > 0
    written = run.interventions.values()
    assert sum(item.count for item in written) > 0
    assert 0.0 < run.interventions["turn_on"].velocity_m_s < budget.WRITTEN_M_S
    given, taken = (sum(getattr(item, key) for item in written) for key in ("given_j", "taken_j"))
    assert abs(given - taken) < run.validity["lost_in_impacts_j"], "what is written is no source of what impacts lose"


def test_energy_and_changes_are_added_up_by_kind() -> None:
    ledger = Ledger(Account)
    for change_j in (2.0, -3.0, 1.0):
        ledger["hold"].write(1e-3, 2e-3, 3e-3, 4e-3, change_j)
    sums = ledger.record()["hold"]
    assert (sums.count, sums.given_j, sums.taken_j) == (3, 3.0, 3.0)
    assert (sums.moved_m, sums.turned_rad, sums.velocity_m_s, sums.rate_rad_s) == pytest.approx(
        (3e-3, 6e-3, 9e-3, 12e-3)
    )


def test_what_the_steps_do_not_explain_fails_the_run() -> None:
    ledger = Ledger(Account)
    ledger["turn_on"].explain(rate_rad_s=0.5, arm_m=1.0, step_s=1e-3)
    ledger["turn_on"].velocity_m_s = 0.5**2 * 1e-3
    assert ledger.record()["turn_on"].velocity_m_s > 0.0
    ledger["turn_on"].velocity_m_s *= 4.0
    with pytest.raises(LayerFault) as fault:
        ledger.record()
    assert fault.value.code == "velocities_unexplained"
    assert fault.value.values["turn_on_m_s"] == pytest.approx(0.001)


State = tuple[float, ...]
Change = Callable[[State, tuple[float, float]], tuple[float, float]]


def sign(before: State, turned: tuple[float, float]) -> tuple[float, float]:
    """ω × arm with the other sign."""
    return -turned[0], -turned[1]


def pivot(before: State, turned: tuple[float, float]) -> tuple[float, float]:
    """About a point a tenth of the base's width, 0.04 m, beside the one that stands."""
    return turned[0], turned[1] + 0.04 * before[11]


def arm(share: float) -> Change:
    """An arm that is longer by a share."""

    def change(before: State, turned: tuple[float, float]) -> tuple[float, float]:
        return turned[0] * (1.0 + share), turned[1] * (1.0 + share)

    return change


SCENES: dict[str, Callable[[], Scene]] = {
    "floor": lambda: paestum(0.429, 3.0, pedestal=False),
    "pedestal": lambda: paestum(0.429, 3.0, mu=0.15),
    "two coefficients": lambda: paestum(0.334, 2.0, mu=(0.20, 0.15)),
} | {f"random {seed}": lambda seed=seed: random_scene(seed) for seed in (740_000, 740_001, 740_002, 740_003)}  # type: ignore[misc]


@pytest.mark.parametrize("case", list(SCENES))
@pytest.mark.parametrize("step_s", [1e-3, 2.5e-4])
@pytest.mark.parametrize(
    "fault", [pivot, sign, arm(0.01), arm(-0.01), None], ids=["pivot", "sign", "+1%", "-1%", "none"]
)
def test_a_wrong_turn_on_fails_the_run(
    case: str, step_s: float, fault: Change | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The velocity into an impact, as it is written: of a pivot, or with an arm, that is not the statue's."""
    engine, scene = ready("pymunk"), SCENES[case]()
    own = RowWriter.write

    def write(self: Any, kind: str, before: State, after: State) -> None:
        if kind == "turn_on" and fault is not None:
            along, up = fault(before, (after[7], after[9]))
            after = (*after[:7], along, after[8], up, *after[10:])
        own(self, kind, before, after)

    monkeypatch.setattr(RowWriter, "write", write)
    settings = engine.settings_for_dt(scene, step_s)
    if fault is None:
        assert engine.simulate(scene, settings, RunOptions()).interventions
        return
    with pytest.raises(LayerFault, match="turn_on"):
        engine.simulate(scene, settings, RunOptions())
