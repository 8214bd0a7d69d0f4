"""A statue that comes to another process again is the one that came before: what was worked out of its mesh is there."""

import pickle

import numpy as np

from tests.scenes_for_tests import rectangle


def test_the_same_bytes_are_the_same_statue() -> None:
    statue = rectangle(0.3, 1.0)
    first, again = pickle.loads(pickle.dumps(statue)), pickle.loads(pickle.dumps(statue))
    assert first is again is not statue
    assert np.array_equal(first.section_m, statue.section_m)
    assert first.mass_kg == statue.mass_kg


def test_another_statue_is_another() -> None:
    one, other = pickle.loads(pickle.dumps(rectangle(0.3, 1.0))), pickle.loads(pickle.dumps(rectangle(0.3, 1.1)))
    assert one is not other
    assert (one.height_m, other.height_m) == (1.0, 1.1)
