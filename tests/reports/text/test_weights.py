"""A note stands under the weight that it has; one of an unknown kind should be known."""

from __future__ import annotations

from reports.text.limits import CHANGES, KNOWN, RECORD, weighed


def test_notes_have_three_weights() -> None:
    decided = "analytic: Beyond 3.46 s the history depends on the integrator's rounding: it is not to be trusted."
    settled = "statue.height_m = 1.46 agrees with 1.46 of the mesh (+0.00 %); used: the mesh"
    other = "statue.depth_m is not given: the base's width, 0.4 m, is assumed"
    assert weighed([settled, decided, other, decided]) == {CHANGES: [decided], KNOWN: [other], RECORD: [settled]}
