"""Keys that are drawn at random: around the scene's value by a share of it, or between two bounds."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.model import InputError
from harness.questions.study.cases import base_of, expand, load_study
from tests import budgets_assess as budget
from tests.harness.questions.study.small_study import BLOCK, written

STUDY = """
title = "scattered"
scene = "block.toml"
samples = 20000
[[variant]]
name = "own"
engines = ["analytic"]
[[scatter]]
"""


def drawn(folder: Path, scatter: str) -> np.ndarray:
    path = written(folder, STUDY + scatter)
    (folder / "block.toml").write_text(f"{BLOCK}[initial]\ntheta_rad = 0.0\n")
    study = load_study(path)
    return np.array([next(iter(case.varied.values())) for case in expand(study, base_of(study, path))])


@pytest.mark.parametrize(
    ("distribution", "sd", "median"),
    [("normal", 0.25, 2.0), ("lognormal", 0.25, 2.0), ("uniform", 0.25 / math.sqrt(3.0), 2.0)],
)
def test_a_key_is_scattered_by_a_share_of_its_value(
    tmp_path: Path, distribution: str, sd: float, median: float
) -> None:
    found = drawn(tmp_path, f'key = "motion.x.frequency_hz"\ndistribution = "{distribution}"\nrelative = 0.25\n')
    assert np.median(found) == pytest.approx(median, rel=budget.MEDIAN_REL)
    assert np.std(found) / np.mean(found) == pytest.approx(sd, rel=budget.SPREAD_REL)


@pytest.mark.parametrize(
    ("scatter", "wanted"),
    [
        (
            'key = "motion.x.frequency_hz"\ndistribution = "normal"\nrelative = 0.1\nlow = 1.0\n',
            "relative.* low",
        ),
        ('key = "motion.x.frequency_hz"\ndistribution = "uniform"\nlow = 1.0\n', "relative.* low"),
        (
            'key = "motion.x.frequency_hz"\ndistribution = "normal"\nlow = 1.0\nhigh = 2.0\n',
            "'uniform'",
        ),
        (
            'key = "initial.theta_rad"\ndistribution = "normal"\nrelative = 0.1\n',
            r"got 0\.0",
        ),
        ('key = "wall.distance_m"\ndistribution = "normal"\nrelative = 0.1\n', "got None"),
    ],
)
def test_what_scatters_nothing_is_refused(tmp_path: Path, scatter: str, wanted: str) -> None:
    with pytest.raises(InputError, match=wanted):
        drawn(tmp_path, scatter)
