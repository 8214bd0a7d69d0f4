"""What an import of the model loads and hands to the compiler: what its first call needs, and no more."""

import subprocess
import sys

import numpy as np

from analytic import Block, Harmonic, ensemble, simulate, spatial
from tests import budgets_analytic as budgets

RUN = """
import analytic
from analytic import spatial
block = analytic.Block.rectangle(width_m=0.2, height_m=1.0)
analytic.simulate(block, analytic.Harmonic(2.0, 2.0), duration_s=0.1)
analytic.ensemble(block, analytic.Harmonic(2.0, 2.0), sweep={"amplitude_m_s2": [1.0, 2.0]}, duration_s=0.1)
spatial.simulate(spatial.Body.block(100.0, 0.4, 0.3, 1.2), duration_s=0.01, friction_static=0.5)
"""


def told(program: str) -> list[str]:
    """Words that a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()


def test_a_start_from_the_cache_needs_no_compiler() -> None:
    block = Block.rectangle(width_m=0.2, height_m=1.0)
    simulate(block, Harmonic(2.0, 2.0), duration_s=0.1)  # compiled by now, if it was not before
    ensemble(block, Harmonic(2.0, 2.0), sweep={"amplitude_m_s2": np.array([1.0, 2.0])}, duration_s=0.1)
    spatial.simulate(spatial.Body.block(100.0, 0.4, 0.3, 1.2), duration_s=0.01, friction_static=0.5)
    names = "\nimport sys; print(*sys.modules)"
    loaded = set(told(RUN + names))
    assert "analytic.machine_code" in loaded
    assert loaded.isdisjoint({"numba", "scipy", "analytic.kernel.integrator", "analytic.spatial.kernel.integrator"})
    used = "\nfrom analytic.kernel.impact import kinetic_energy\nkinetic_energy(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)"
    assert "numba" in told(RUN + used + names), "a function of the kernel by itself needs it"


def test_an_import_of_the_model_loads_little_beside_numpy_and_the_loader() -> None:
    before, after = "import numpy, llvmlite.binding", "import analytic; analytic.simulate"
    names = "; import sys; print(*sys.modules)"
    known = set(told(before + names))
    more = set(told(f"{before}; {after}{names}")) - known
    assert "analytic.solver" in more
    assert not any(name.startswith("scipy") for name in more)
    assert len(more) <= budgets.MODULES_OF_IMPORT
    wide = set(told(f"{before}; {after}; import analytic.closed_form, scipy.special{names}")) - known
    assert len(wide) > budgets.MODULES_OF_IMPORT, "the budget does not see scipy: it sees nothing"


def test_a_motion_starts_no_compiler() -> None:
    loaded = told("import analytic; analytic.Harmonic(1.0, 1.0); import sys; print(*sys.modules)")
    assert "analytic.excitation" in loaded
    assert "numba" not in loaded
