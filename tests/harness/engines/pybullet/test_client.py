"""Some of Bullet's settings are the whole process's: a run gives the same bits whatever ran before, failed, or runs beside."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pybullet
import pytest

from analytic.excitation import Harmonic
from harness import Run, RunOptions, Scene
from harness.engines.base import EngineFailure
from tests.engines_for_tests import NOTHING_SKIPPED, WHOLE, bullet
from tests.scenes_for_tests import paestum

CASES: dict[str, tuple[Scene, RunOptions]] = {
    "floor": (paestum(0.429, 3.0, pedestal=False, duration_s=0.4), RunOptions()),
    "pedestal": (paestum(0.429, 3.0, mu=(0.20, 0.15), duration_s=0.55), RunOptions()),
    "whole": (paestum(0.429, 3.0, duration_s=0.4), WHOLE),
    "full shape": (paestum(0.334, 3.0, duration_s=0.3), NOTHING_SKIPPED),
}


def run(name: str) -> Run:
    case, options = CASES[name]
    return bullet(case, 1e-3, options)


def bits(result: Run) -> bytes:
    return b"".join(np.ascontiguousarray(values).tobytes() for values in result.history.columns().values())


@pytest.fixture(scope="module")
def alone() -> dict[str, bytes]:
    """What each case gives at first."""
    return {name: bits(run(name)) for name in CASES}


@pytest.mark.parametrize(
    "order", [("floor", "pedestal", "whole", "full shape"), ("full shape", "whole", "pedestal", "floor")]
)
def test_no_run_sees_the_settings_of_another(alone: dict[str, bytes], order: tuple[str, ...]) -> None:
    odd = paestum(0.6, 2.0, duration_s=0.05)
    for name in (*order, *order):
        bullet(odd, 5e-4, reach=2e-2, erp=0.5, iterations=7, cone_friction=False, reversed_bodies=True)
        assert bits(run(name)) == alone[name], name


def test_a_run_that_fails_ends_its_client(alone: dict[str, bytes], monkeypatch: pytest.MonkeyPatch) -> None:
    case, options = CASES["pedestal"]
    ended: list[int] = []
    own = pybullet.disconnect
    monkeypatch.setattr(pybullet, "disconnect", lambda client: (ended.append(client), own(client)))

    def fails(t_s: float, theta_rad: float) -> bool:
        raise ArithmeticError("stopped from outside")

    with pytest.raises(EngineFailure, match="stopped from outside"):
        bullet(case, 1e-3, replace(options, stop=fails))
    assert len(ended) == 1
    assert not pybullet.isConnected(ended[0])
    assert bits(run("pedestal")) == alone["pedestal"]


def test_a_run_inside_a_run_and_runs_in_threads_do_not_meet(alone: dict[str, bytes]) -> None:
    case, options = CASES["pedestal"]
    inner: list[bytes] = []

    def looks(t_s: float, theta_rad: float) -> bool:
        if not inner:
            inner.append(bits(run("floor")))
        return False

    assert bits(bullet(case, 1e-3, replace(options, stop=looks))) == alone["pedestal"]
    assert inner == [alone["floor"]]
    with ThreadPoolExecutor(3) as pool:
        names = list(CASES) * 2
        assert list(pool.map(lambda name: bits(run(name)) == alone[name], names)) == [True] * len(names)


def test_a_table_that_moves() -> None:
    case = replace(paestum(0.3, 3.0, duration_s=0.2), table="moving")
    case = replace(case, base_excitation=replace(case.base_excitation, z=Harmonic(1.0, 5.0)))
    first = bits(bullet(case, 1e-3))
    run("floor")
    assert bits(bullet(case, 1e-3)) == first
