"""Entries of compiled code, called without their compiler: kept as object code, loaded by LLVM alone.

To import the compiler costs a second of processor time, to load its own cache half of one more; LLVM's loader takes 40 ms.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import hashlib
import importlib.util
import os
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final, final

import llvmlite
import llvmlite.binding as llvm

from analytic._cache import home_of
from analytic.compiling import say

try:
    import fcntl
except ImportError:  # another system than the ones it is for
    fcntl = None  # type: ignore[assignment]

LISTED: Final = b"\n"
"""Ends each line of the list before the object code: its digest, symbol, number of arguments, and the symbols that it needs."""
_LOCK: Final = threading.Lock()
_ENGINES: Final[list[llvm.ExecutionEngine]] = []
"""Owners of the loaded code: it lives as long as they do."""


def _machine() -> llvm.TargetMachine:
    """This processor, with all its instructions; as the compiler sets it up, but without its passes."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_triple(llvm.get_process_triple())
    features = llvm.get_host_cpu_features().flatten()
    kind = {"opt": 3, "reloc": "default", "codemodel": "jitdefault", "jit": True}
    return target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, **kind)


def _setup() -> str:
    """What object code depends on beside its sources."""
    features = llvm.get_host_cpu_features().flatten()
    host = llvm.get_host_cpu_name(), features, llvm.get_process_triple(), llvmlite.__version__, sys.version
    return hashlib.sha256("\n".join(host).encode()).hexdigest()[:16]


def _own_ends(text: str) -> str:
    """A module that ends the process where code would ask the compiler's run time for help.

    Our compiled functions allocate nothing and raise nothing; only what wraps them names such functions, for that case.
    """
    lines = [
        line for line in text.splitlines() if line.startswith("declare") and ("@numba_" in line or "@NRT_" in line)
    ]
    bodies = [f"define linkonce_odr {line.removeprefix('declare ').split(' local_unnamed_addr')[0]}" for line in lines]
    return "declare void @abort()\n" + "\n".join(f"{body} {{\n call void @abort()\n unreachable\n}}" for body in bodies)


@final
class Entry:
    """A compiled function of integers (addresses, sizes, indices) that returns nothing; without the interpreter's lock."""

    def __init__(self, module: str, name: str) -> None:
        """Name it; it is loaded, or compiled, by its first call."""
        self.module, self.name = module, name
        self._call: Callable[..., None] | None = None

    def __call__(self, *words: int) -> None:
        """Run it."""
        call = self._call or self._loaded()
        call(*words)

    def _loaded(self) -> Callable[..., None]:
        with _LOCK:  # many threads may come first
            if self._call is None:
                path = self._path
                self._call = _loaded(path)
                if self._call is None:
                    with _alone(path):
                        # Another process may have compiled it in the meantime.
                        self._call = _loaded(path) or self._compiled(path)
            return self._call

    @property
    def is_stored(self) -> bool:
        """Whether it was compiled before, by this process or another."""
        path = self._path
        return path is not None and path.exists()

    @property
    def _path(self) -> Path | None:
        folder = home_of(self._room)
        return None if folder is None else folder / f"{self.name}-{_setup()}.o"

    @property
    def _room(self) -> Path:
        spec = importlib.util.find_spec(self.module.rpartition(".")[0])
        assert spec is not None
        assert spec.origin is not None
        return Path(spec.origin).resolve().parent

    def _compiled(self, path: Path | None) -> Callable[..., None]:
        """Compile it, and keep what comes out where it can be kept."""
        from analytic.kernel.compiler import Inner, c_code, c_function

        function = getattr(importlib.import_module(self.module), self.name)
        Inner.on_made = lambda done, total: say(min(done, total - 1), total)  # the last is begun, not done
        collects = gc.isenabled()
        gc.disable()  # a million objects live to the end: to look through them takes a sixth of the time
        try:
            symbol, text = c_code(function)
        finally:
            Inner.on_made = None
            if collects:
                gc.enable()
            say(Inner.total, Inner.total)
        content = _listed(symbol, function.__code__.co_argcount, text)
        if path is not None:
            _write(path, content)
        # The very code that later processes load, so that all have the same bits; the compiler's own where it cannot be linked.
        call: Callable[..., None] = _linked(content) or c_function(function).ctypes
        return call


def _listed(symbol: str, arguments: int, text: str) -> bytes:
    """What is kept of LLVM's text of a function: its object code behind the list of what loading needs."""
    module = llvm.parse_assembly(text)
    module.link_in(llvm.parse_assembly(_own_ends(text)))
    code: bytes = _machine().emit_object(module)
    needs = sorted(each.name for each in module.functions if each.is_declaration and not each.name.startswith("llvm."))
    lines = symbol, str(arguments), ",".join(needs)
    listed = LISTED.join(line.encode() for line in lines) + LISTED + code
    return hashlib.sha256(listed).hexdigest().encode() + LISTED + listed


def _loaded(path: Path | None) -> Callable[..., None] | None:
    """The function that was kept, None where there is none, or this process cannot run it."""
    content = None if path is None else _read(path)
    return None if content is None else _linked(content)


@contextlib.contextmanager
def _alone(path: Path | None) -> Iterator[None]:
    """Compile while no other process compiles the same; where files cannot be locked, at once."""
    with contextlib.ExitStack() as stack:
        if path is not None and fcntl is not None:
            with contextlib.suppress(OSError):
                fcntl.flock(stack.enter_context(path.with_suffix(".lock").open("w")), fcntl.LOCK_EX)
        yield


def _read(path: Path) -> bytes | None:
    """What was kept, None where there is nothing whole."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    written, _, rest = content.partition(LISTED)
    return content if hashlib.sha256(rest).hexdigest().encode() == written else None


def _write(path: Path, content: bytes) -> None:
    """Whole or not at all; another process may write the same."""
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(content)
        os.replace(file.name, path)
    except OSError as error:
        message = (
            f"compiled code could not be kept in {path.parent} ({error.strerror}): the next start compiles it again"
        )
        warnings.warn(message, RuntimeWarning, stacklevel=2)


def _linked(content: bytes) -> Callable[..., None] | None:
    """The function in object code; None where this process lacks something that it needs."""
    _, symbol, count, needs, code = content.split(LISTED, 4)
    try:
        process = ctypes.CDLL(None)
        for name in filter(None, needs.decode().split(",")):
            llvm.add_symbol(name, ctypes.cast(process[name], ctypes.c_void_p).value or 0)
    except (AttributeError, OSError, TypeError):  # a symbol is missing, or the system has no such list of them
        return None  # LLVM would end the process
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _ENGINES.append(engine)
    kind = ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * int(count))
    return kind(engine.get_function_address(symbol.decode()))
