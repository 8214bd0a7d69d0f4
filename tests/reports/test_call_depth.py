"""How many calls of the product's own code lie between a command and the step of an engine: a reader follows each of them."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import pytest
from typer.testing import CliRunner

from reports.cli import app
from tests.budgets_reports import CALLS_AROUND_AN_EVENT, CALLS_TO_A_STEP, CALLS_TO_A_VERIFYING_STEP

ROOT = Path(__file__).resolve().parents[2]
ROOMS = tuple(f"{ROOT / room}/" for room in ("reports", "harness", "analytic", "meshes"))


def calls(stack: tuple[CodeType, ...]) -> tuple[str, ...]:
    """The product's functions from the command's own, the first, to the innermost."""
    product = (code for code in reversed(stack) if code.co_filename.startswith(ROOMS))
    names = [f"{Path(code.co_filename).relative_to(ROOT)}:{code.co_name}" for code in product]
    return tuple(names[names.index("reports/cli/commands.py:run") :])


def ways_to(steps: Callable[[FrameType, str, Any], bool], line: list[str]) -> set[tuple[str, ...]]:
    """Every way in which a command comes to a step."""
    stacks: set[tuple[CodeType, ...]] = set()

    def hear(frame: FrameType | None, event: str, arg: Any) -> None:
        if frame is not None and steps(frame, event, arg):
            stack = []
            while frame is not None:
                stack.append(frame.f_code)
                frame = frame.f_back
            stacks.add(tuple(stack))

    before = sys.getprofile()
    sys.setprofile(hear)
    try:
        done = CliRunner().invoke(app, line)
    finally:
        sys.setprofile(before)
    assert done.exit_code == 0, done.output
    return {calls(stack) for stack in stacks}


def of_pybullet(_frame: FrameType, event: str, arg: Any) -> bool:
    return event == "c_call" and getattr(arg, "__name__", "") == "stepSimulation"


def of_pymunk(_frame: FrameType, event: str, arg: Any) -> bool:
    return event == "c_call" and getattr(arg, "__name__", "") == "cpSpaceStep"


def of_analytic(frame: FrameType, event: str, _arg: Any) -> bool:
    """The function that calls compiled code, in which all steps are made."""
    return event == "call" and (frame.f_code.co_name, Path(frame.f_code.co_filename).name) == ("solve", "solver.py")


@pytest.mark.parametrize(
    ("engine", "steps"),
    [
        ("pybullet:plain", of_pybullet),
        ("pybullet", of_pybullet),
        ("pymunk:plain", of_pymunk),
        ("pymunk", of_pymunk),
        ("analytic", of_analytic),
    ],
)
def test_a_step_is_a_few_calls_from_the_command(
    engine: str, steps: Callable[[FrameType, str, Any], bool], tmp_path: Path
) -> None:
    if engine.startswith("pybullet"):
        pytest.importorskip("pybullet", reason="pybullet has no wheels here")
    # So small a lean comes to its first impacts within that time.
    sets = ["--set", "duration_s=0.2", "--set", "initial.theta_rad=0.005"]
    options = [*sets, "--no-assess", "--out", str(tmp_path / "out")]
    ways = ways_to(steps, ["run", str(ROOT / "scenes" / "free_rocking.toml"), "-e", engine, *options])
    assert ways
    if engine in ("pymunk", "pybullet"):
        assert max(map(len, ways)) > CALLS_TO_A_VERIFYING_STEP, "no event was located"
    for way in ways:
        verifying = any(name.endswith("refinement.py:response") for name in way)
        most = CALLS_TO_A_VERIFYING_STEP if verifying else CALLS_TO_A_STEP
        located = any(name.endswith(("loop.py:locate_event", "step_state.py:step")) for name in way)
        most = CALLS_AROUND_AN_EVENT if located else most
        assert len(way) <= most, "\n".join(way)
