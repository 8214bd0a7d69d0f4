"""What the measures change in the program is there: a name that moved would make a mutant of nothing."""

from functools import reduce
from importlib import import_module

import pytest

from tests.engines_for_tests import ready
from tests.measures import mechanisms, steering_mutants

TARGETS = sorted(
    {
        target
        for table in (mechanisms.MUNK, mechanisms.BULLET, *vars(steering_mutants).values())
        if isinstance(table, dict)
        for changes in table.values()
        if isinstance(changes, dict)
        for target in changes
        if isinstance(target, str) and target.startswith("harness.")
    }
)


def test_both_tables_name_targets() -> None:
    assert any("stepping.step_state" in target for target in TARGETS)
    assert any("stepping.loop" in target for target in TARGETS)


@pytest.mark.parametrize("target", TARGETS)
def test_what_is_changed_is_there(target: str) -> None:
    for engine in ("pymunk", "pybullet"):
        if f"engines.{engine}" in target:
            ready(engine)
    module, _, name = target.partition(":")
    assert reduce(getattr, name.split("."), import_module(module)) is not None
