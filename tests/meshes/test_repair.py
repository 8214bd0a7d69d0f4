"""The outline fitted to a noisy rim: unbiased sides, true corners, quiet and curved rims left alone."""

import numpy as np
import pytest

from meshes.repair import fit_outline
from tests.budgets_meshes import OUTLINE_NOISE_SHARE

NOISE_M = 1e-3


def rectangle(step: float = 0.01) -> np.ndarray:
    """A rim of 0.43 by 0.72 m, counter-clockwise, a point every centimetre or so."""
    corners = np.array([[0.0, 0.0], [0.43, 0.0], [0.43, 0.72], [0.0, 0.72]])
    sides = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        share = np.arange(0.0, 1.0, step / np.linalg.norm(b - a))[:, None]
        sides.append(a + share * (b - a))
    return np.vstack(sides)


@pytest.mark.parametrize("seed", range(8))
def test_a_noisy_rectangle_is_not_widened(seed: int) -> None:
    """The raw rim is too wide by some standard deviations on every side; the fitted one by a fraction of one."""
    random = np.random.default_rng(seed)
    clean = rectangle()
    rim = clean + random.normal(0.0, NOISE_M, clean.shape)
    raw = np.ptp(rim, axis=0) - np.ptp(clean, axis=0)
    points, noise_m = fit_outline(rim)
    apart = np.abs(np.ptp(points, axis=0) - np.ptp(clean, axis=0))
    assert raw.min() > 2.0 * NOISE_M
    assert apart.max() < OUTLINE_NOISE_SHARE * NOISE_M
    assert noise_m == pytest.approx(NOISE_M, rel=0.25)


def test_a_quiet_rim_is_left_alone() -> None:
    rim = rectangle()
    points, noise_m = fit_outline(rim)
    assert points is rim
    assert noise_m == 0.0


TURN = 2.0 * np.pi * np.arange(240) / 240
ROUND = 0.3 * np.column_stack([np.cos(TURN), np.sin(TURN)])


def test_a_smooth_round_base_stays_round() -> None:
    points, _ = fit_outline(ROUND)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.3, atol=NOISE_M)


@pytest.mark.parametrize("seed", range(4))
def test_a_noisy_round_base_keeps_its_size(seed: int) -> None:
    random = np.random.default_rng(seed)
    points, _ = fit_outline(ROUND + random.normal(0.0, NOISE_M, ROUND.shape))
    radius = np.linalg.norm(points, axis=1)
    assert radius.mean() == pytest.approx(0.3, abs=NOISE_M)
    assert np.abs(radius - 0.3).max() < 5.0 * NOISE_M
