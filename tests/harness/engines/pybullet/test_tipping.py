"""A pedestal that tips: the layer that locates events leaves the engine to plain steps there, and says from when."""

import pytest

from tests import budgets_engines as budget
from tests.engines_for_tests import apart, bullet
from tests.measures.seeded_scenes import tipping_scene
from tests.scenes_for_tests import paestum


@pytest.mark.parametrize("seed", [0, 2, 4, 5])
def test_nothing_is_located_while_the_pedestal_tips(seed: int) -> None:
    """From rest both bodies tip as one: events located in it shifted these by 3e-3 to 6e-2 rad at 1 ms."""
    located, plain = (bullet(tipping_scene(seed), 1e-3, events=events) for events in (True, False))
    assert plain.validity["pedestal_tilt_rad"] > budget.TIPS_RAD
    assert apart(located, plain) <= budget.TIPPING_RAD
    assert 0.0 < located.validity["plain_from_s"] < located.end_s
    assert 0.0 < located.validity["plain_for_s"] <= located.end_s - located.validity["plain_from_s"]


def test_a_pedestal_that_stands_is_never_left_to_plain_steps() -> None:
    run = bullet(paestum(0.334, 3.0), 1e-3)
    assert run.validity["plain_from_s"] is None
    assert run.validity["plain_for_s"] == 0.0
