"""Numbers read as a person would write them."""

import pytest

from reports.messages import ENGLISH, language
from reports.pages.run_page import toml_text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.087893, "0.0879"),
        (-0.0878, "−0.0878"),
        (1.0, "1.00"),
        (707.0, "707"),
        (12345.6, "12346"),
        (2.5e-4, "2.5·10⁻⁴"),
        (1e-10, "1·10⁻¹⁰"),
        (4.13e-19, "0"),
        (2.123e7, "2.12·10⁷"),
        (None, "–"),
        (float("nan"), "–"),
        (9.994, "9.99"),
    ],
)
def test_digits(value: float | None, text: str) -> None:
    assert ENGLISH.digits(value) == text


@pytest.mark.parametrize(
    ("value_m", "text"),
    [(1.46, "1.46 m"), (0.7, "70 cm"), (0.3585, "35.9 cm"), (0.0682, "6.8 cm"), (0.0012, "1.2 mm"), (1e-9, "0 mm")],
)
def test_lengths(value_m: float, text: str) -> None:
    assert ENGLISH.length(value_m) == text.replace(" ", "\u00a0")


def test_lists_and_ranges() -> None:
    assert ENGLISH.listed(["a"]) == "a"
    assert ENGLISH.listed(["a", "b", "c"]) == "a, b and c"
    assert ENGLISH.range(["0.213", "0.213"]) == "0.213"
    assert ENGLISH.range(["0.178", "0.213"]) == "0.178 to 0.213"


def test_keys_become_headings() -> None:
    assert ENGLISH.label("lean_rad") == "lean [rad]"
    assert ENGLISH.label("accel_m_s2") == "accel [m/s²]"
    assert ENGLISH.label("own_steps") == "own steps"
    assert ENGLISH.label("motion.x.amplitude_g") == "amplitude [g]"
    assert ENGLISH.label("contact.statue") != ENGLISH.label("statue"), "a coefficient is no statue"
    assert ENGLISH.label("pedestal.mass_kg") != ENGLISH.label("statue.mass_kg"), "a study may vary both"


def test_any_value_of_a_record_fits_a_cell() -> None:
    assert ENGLISH.plain({"kept": True}) == "kept yes"
    assert ENGLISH.plain([0.1] * 20).endswith("… (20)")
    assert ENGLISH.plain({"kind": "harmonic", "frequency_hz": 3.0}) == "kind harmonic, frequency 3\u00a0Hz"


def test_toml_reads_back_as_given() -> None:
    import tomllib

    content = {
        "title": 'a "quoted" \\ title',
        "duration_s": 10.0,
        "flag": True,
        "motion": {"x": {"kind": "pulse", "values": [1.0, 2.5e-7]}, "odd key": {"count": 3}},
        "empty": {},
    }
    assert tomllib.loads(toml_text(content)) == content


def test_values_one_after_another_are_told_apart_from_their_decimals() -> None:
    assert ENGLISH.plain([0.5, 1.25]) == "0.5000, 1.250"
    assert language("it").plain([0.5, 1.25]) == "0,5000; 1,250"
    assert ENGLISH.plain([1] * 13).endswith(", 1, … (13)")


def test_a_whole_number_below_nought_has_the_same_sign_as_others() -> None:
    """A table of quarter turns had -4 beside −0.978."""
    assert [language(code).plain(value) for code in ("en", "it") for value in (-4, -4.5)] == [
        "−4",
        "−4.500",
        "−4",
        "−4,500",
    ]
