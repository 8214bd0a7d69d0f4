"""The examples in the library's docstrings run as printed."""

import doctest

import pytest

import analytic
from analytic import closed_form, pulse_response


@pytest.mark.parametrize("module", [analytic, closed_form, pulse_response])
def test_examples_in_docstrings_run_as_printed(module: object) -> None:
    found = doctest.testmod(module)  # type: ignore[arg-type]
    assert found.attempted >= 3
    assert found.failed == 0


def test_help_names_what_is_public() -> None:
    assert set(analytic.__all__) <= set(dir(analytic))
    for name in analytic.__all__:
        assert getattr(analytic, name).__doc__, name
