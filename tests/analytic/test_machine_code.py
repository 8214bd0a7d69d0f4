"""Compiled entries called without their compiler: loaded where they are whole, compiled where they are not."""

import importlib
import math
import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from analytic import machine_code
from analytic import machine_code as compiling
from analytic.kernel import compiler

TINY = '''
import math
from analytic.kernel.compiler import jit
from analytic.kernel.compiler import load_double, store_double

@jit
def power(x, n):
    return x**n

def powers(at: int, n: int) -> None:
    """The n-th power, and the arc cosine, of a number between 0 and 1: something of the kernel, something of the C library."""
    x = load_double(at, 0)
    store_double(at, 1, power(x, n))
    store_double(at, 2, math.acos(x))
'''


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], machine_code.Entry]:
    """Makes an entry of a room of its own, as a new process would find it."""
    name = f"room_{tmp_path.name}"
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("")
    (tmp_path / name / "tiny.py").write_text(TINY)
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    yield lambda: machine_code.Entry(f"{name}.tiny", "powers")
    for each in (name, f"{name}.tiny"):
        sys.modules.pop(each, None)


def powers(entry: machine_code.Entry) -> tuple[float, float]:
    numbers = np.array([0.5, 0.0, 0.0])
    entry(numbers.ctypes.data, 3)
    return float(numbers[1]), float(numbers[2])


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of what is handed to the compiler."""
    names = []
    real = compiler.c_code
    monkeypatch.setattr(compiler, "c_code", lambda function: (names.append(function.__name__), real(function))[1])
    return names


def kept(entry: machine_code.Entry) -> Path:
    (path,) = entry._path.parent.glob("powers-*.o")
    return path


EXPECTED = (0.125, math.acos(0.5))


def test_what_was_compiled_once_is_loaded_the_next_time(
    tiny: Callable[[], machine_code.Entry], compiled: list[str]
) -> None:
    assert powers(tiny()) == EXPECTED
    assert compiled == ["powers"]
    assert powers(tiny()) == EXPECTED
    assert compiled == ["powers"]


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.999])
def test_what_is_cut_short_is_compiled_again(
    tiny: Callable[[], machine_code.Entry], compiled: list[str], share: float
) -> None:
    powers(tiny())
    path = kept(tiny())
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    assert powers(tiny()) == EXPECTED
    assert len(compiled) == 2
    assert powers(tiny()) == EXPECTED
    assert len(compiled) == 2, "it was kept again"


def test_what_this_process_cannot_link_is_compiled_again(
    tiny: Callable[[], machine_code.Entry], compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    powers(tiny())
    real = machine_code.ctypes.CDLL

    class Poor:
        def __init__(self, name: None) -> None:
            self.real = real(name)

        def __getitem__(self, name: str) -> object:
            if name == "acos":
                raise AttributeError(name)
            return self.real[name]

    monkeypatch.setattr(machine_code.ctypes, "CDLL", Poor)
    assert powers(tiny()) == EXPECTED
    assert len(compiled) == 2


def test_many_threads_compile_once(tiny: Callable[[], machine_code.Entry], compiled: list[str]) -> None:
    entry = tiny()
    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(lambda _: powers(entry), range(32))) == {EXPECTED}
    assert len(compiled) == 1


def test_whoever_listens_hears_that_it_compiles(tiny: Callable[[], machine_code.Entry]) -> None:
    said: list[tuple[int, int]] = []

    def hear(done: int, total: int) -> None:
        said.append((done, total))

    compiling.listeners.append(hear)
    try:
        powers(tiny())
    finally:
        compiling.listeners.remove(hear)
    assert said
    assert said[-1][0] == said[-1][1] > 0
    assert [done == total for done, total in said].count(True) == 1, "it ends once"
    heard = len(said)
    powers(tiny())
    assert len(said) == heard, "nothing is compiled the second time, and nobody listens"


def test_the_processor_and_the_loader_name_what_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    before = machine_code._setup()
    monkeypatch.setattr(machine_code.llvm, "get_host_cpu_name", lambda: "another")
    assert machine_code._setup() != before
    monkeypatch.undo()
    monkeypatch.setattr(machine_code.llvmlite, "__version__", "0")
    assert machine_code._setup() != before


HEARING = """
import sys
import numpy as np
from analytic import machine_code
from analytic import machine_code as compiling
compiling.listeners.append(lambda done, total: print("compiled"))
machine_code.Entry(sys.argv[1], "powers")(np.zeros(3).ctypes.data, 3)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="files are not locked there")
def test_processes_that_start_together_compile_once(tiny: Callable[[], machine_code.Entry], tmp_path: Path) -> None:
    command = [sys.executable, "-c", HEARING, tiny().module]
    path = os.pathsep.join([str(tmp_path), *sys.path])
    both = [subprocess.Popen(command, env=os.environ | {"PYTHONPATH": path}, stdout=subprocess.PIPE) for _ in range(2)]
    told = [process.communicate()[0] for process in both]
    assert [process.returncode for process in both] == [0, 0]
    assert sorted(b"compiled" in each for each in told) == [False, True]
