"""What an import of the model loads and hands to the compiler: what its first call needs, and no more."""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from analytic import Block, Harmonic, ensemble, simulate
from tests import budgets_analytic as budgets

RUN = """
import analytic
block = analytic.Block.rectangle(width_m=0.2, height_m=1.0)
analytic.simulate(block, analytic.Harmonic(2.0, 2.0), duration_s=0.1)
analytic.ensemble(block, analytic.Harmonic(2.0, 2.0), sweep={"amplitude_m_s2": [1.0, 2.0]}, duration_s=0.1)
"""
COUNT = """
import sys
from numba.core.dispatcher import Dispatcher
from analytic.kernel.compiler import Inner
kept = {id(each): each for name, module in sys.modules.items() if name.startswith("analytic.")
        for each in vars(module).values() if isinstance(each, (Inner, Dispatcher))}.values()
made = [each.__name__ for each in kept if isinstance(each, Dispatcher) or "_made" in vars(each)]
print(len(kept), *sorted(made))
"""


def told(program: str) -> list[str]:
    """Words that a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()


def test_a_start_from_the_cache_hands_the_compiler_its_entries_only() -> None:
    block = Block.rectangle(width_m=0.2, height_m=1.0)
    simulate(block, Harmonic(2.0, 2.0), duration_s=0.1)  # compiled by now, if it was not before
    ensemble(block, Harmonic(2.0, 2.0), sweep={"amplitude_m_s2": np.array([1.0, 2.0])}, duration_s=0.1)
    functions, *made = told(RUN + COUNT)
    assert made == ["run", "run_rows"]
    assert int(functions) > 90, "the inner functions are not seen: so are none that were made"
    used = "\nfrom analytic.kernel.impact import kinetic_energy\nkinetic_energy(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)\n"
    assert "kinetic_energy" in told(RUN + used + COUNT)[1:], "a function that was made is not seen"


def test_an_import_of_the_model_loads_little_beside_numpy_and_numba() -> None:
    before, after = "import numpy, numba", "import analytic; analytic.simulate"
    names = "; import sys; print(*sys.modules)"
    known = set(told(before + names))
    more = set(told(f"{before}; {after}{names}")) - known
    assert "analytic.kernel.integrator" in more
    assert not any(name.startswith("scipy") for name in more)
    assert len(more) <= budgets.MODULES_OF_IMPORT
    wide = set(told(f"{before}; {after}; import analytic.closed_form, scipy.special{names}")) - set(
        told(before + names)
    )
    assert len(wide) > budgets.MODULES_OF_IMPORT, "the budget does not see scipy: it sees nothing"


def test_a_motion_starts_no_compiler() -> None:
    loaded = told("import analytic; analytic.Harmonic(1.0, 1.0); import sys; print(*sys.modules)")
    assert "analytic.excitation" in loaded
    assert "numba" not in loaded
