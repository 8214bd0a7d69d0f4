"""Entries of compiled code, called without their compiler: kept as object code, loaded by LLVM alone.

To import the compiler costs a second of processor time, to load its own cache half of one more; LLVM's loader takes 40 ms.
"""

import contextlib
import ctypes
import gc
import hashlib
import importlib
import os
import shutil
import stat
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Final, final

import llvmlite
import llvmlite.binding as llvm

# Who hears that code is being compiled, which takes half a minute once after an upgrade.

OnCompile = Callable[[int, int], None]
"""Called as functions are compiled: how many are begun and how many there are, at the end as many as there are."""
listeners: Final[list[OnCompile]] = []
"""Called whenever code has to be compiled: whoever wants to hear of it adds itself, and takes itself away."""


def say(done: int, total: int) -> None:
    """Call them all."""
    for each in listeners:
        each(done, total)


# Where compiled code is kept: one folder for each state of the sources, the newest two of them. The compiler's own cache
# notices a change of a function's file, not one of a file that it calls into: so the cache stands in a folder named after the
# digest of all compiled sources. What is kept there is run: so it is taken only from folders into which nobody else can write.

MOST_FOLDERS: Final = 2
"""Folders kept: this state of the sources and the one before, to which one may go back."""
PREFIX: Final = "compiled-"
KERNEL: Final = Path(__file__).resolve().parent / "kernel"
"""The room whose sources every other room of compiled code uses."""
OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
"""Bits of a mode that let others write."""


def digest(*rooms: Path) -> str:
    """Digest of every source in the folders of compiled code; nothing outside them may decide what is compiled."""
    state = hashlib.sha256()
    for room in rooms:
        for source in sorted(room.glob("*.py")):
            state.update(source.read_bytes())
    return state.hexdigest()[:16]


def homes(sources: Path) -> Iterator[Path]:
    """Where a cache may stand, best first: beside the sources, in the user's cache, among temporary files."""
    yield sources / "__pycache__"
    given = os.environ.get("XDG_CACHE_HOME")
    with contextlib.suppress(RuntimeError):  # nobody's home is known
        yield (Path(given) if given else Path.home() / ".cache") / "rockcheck"
    user = os.getuid() if hasattr(os, "getuid") else os.environ.get("USERNAME", "")
    yield Path(tempfile.gettempdir()) / f"rockcheck-{user}"


def folder(sources: Path, *shared: Path) -> Path | None:
    """The folder for the compiled code of these sources and those that they share, older ones removed; None where nothing can be
    written."""
    name = PREFIX + digest(sources, *shared)
    for home in homes(sources):
        chosen = home / name
        known = chosen.is_dir()
        if not (_private(home, sources) and _writable(chosen) and _private(chosen, sources)):
            continue
        if not known:
            prune(home)
        return chosen
    return None


@cache
def home_of(room: Path = KERNEL) -> Path | None:
    """Folder of the compiled code of a room's very sources; None, with a warning, where nothing can be written."""
    chosen = folder(room, *([] if room == KERNEL else [KERNEL]))
    if chosen is None:
        warnings.warn(
            "no folder can be written in which to keep compiled code: every start compiles it again (set XDG_CACHE_HOME)",
            RuntimeWarning,
            stacklevel=2,
        )
    return chosen


def prune(home: Path, most: int = MOST_FOLDERS) -> None:
    """Remove all but the newest folders of compiled code.

    Safe while other processes run: the compiler takes a file that is gone for one that was never written.
    """
    folders = []
    for each in home.glob(PREFIX + "*"):
        try:
            folders.append((each.stat().st_mtime_ns, each))
        except FileNotFoundError:  # removed by another process just now
            continue
    for _, old in sorted(folders, reverse=True)[most:]:
        shutil.rmtree(old, ignore_errors=True)


def _private(path: Path, sources: Path) -> bool:
    """Whether a folder, made where it is not there yet, is no link and its user's own, and nobody else may write into it.

    Beside the sources it may be theirs who own these, and as open as these: who can write there can change the code itself.
    """
    try:
        path.mkdir(mode=0o700, parents=True, exist_ok=True)
        seen, above, code = path.lstat(), path.parent.stat(), sources.stat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):  # folders have no such owner
        return not path.is_symlink()
    owners, open_to = {os.getuid()}, 0
    if sources in path.parents:
        owners, open_to = owners | {code.st_uid}, code.st_mode
    # Where others may write and no sticky bit holds them off, they could put a folder of theirs in its place.
    replaceable = above.st_mode & OTHERS & ~open_to and not above.st_mode & stat.S_ISVTX
    return (
        stat.S_ISDIR(seen.st_mode) and seen.st_uid in owners and not (seen.st_mode & OTHERS & ~open_to or replaceable)
    )


def _writable(chosen: Path) -> bool:
    """Whether files can be made there, tried rather than asked: the superuser is told yes of a read-only disk."""
    try:
        chosen.mkdir(mode=0o700, exist_ok=True)
        with tempfile.TemporaryFile(dir=chosen):
            return True
    except OSError:
        return False


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
    return target.create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="default",
        codemodel="jitdefault",
        jit=True,
    )


def _setup() -> str:
    """What object code depends on beside its sources."""
    host = (
        llvm.get_host_cpu_name(),
        llvm.get_host_cpu_features().flatten(),
        llvm.get_process_triple(),
        llvmlite.__version__,
        sys.version,
    )
    return hashlib.sha256("\n".join(host).encode()).hexdigest()[:16]


def _own_ends(text: str) -> str:
    """A module that ends the process where code would ask the compiler's run time for help.

    Our compiled functions allocate nothing and raise nothing; only what wraps them names such functions, for that case.
    """
    heads = [
        line.removeprefix("declare ").split(" local_unnamed_addr")[0]
        for line in text.splitlines()
        if line.startswith("declare") and ("@numba_" in line or "@NRT_" in line)
    ]
    ends = [f"define linkonce_odr {head} {{\n call void @abort()\n unreachable\n}}" for head in heads]
    return "\n".join(["declare void @abort()", *ends])


@final
class Entry:
    """A compiled function of integers (addresses, sizes, indices) that returns nothing; without the interpreter's lock."""

    def __init__(self, module: str, name: str) -> None:
        """Name it; it is loaded, or compiled, by its first call."""
        self.module, self.name = module, name
        self._call: Callable[..., None] | None = None

    def __call__(self, *words: int) -> None:
        """Run it."""
        (self._call or self.loaded())(*words)

    def loaded(self) -> Callable[..., None]:
        """The function; compiled first where it is not kept, which whoever times a call does before."""
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
        room = importlib.import_module(self.module.rpartition(".")[0])
        folder = home_of(Path(room.__path__[0]).resolve())
        return None if folder is None else folder / f"{self.name}-{_setup()}.o"

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
    listed = LISTED.join(line.encode() for line in (symbol, str(arguments), ",".join(needs))) + LISTED + code
    return hashlib.sha256(listed).hexdigest().encode() + LISTED + listed


def _loaded(path: Path | None) -> Callable[..., None] | None:
    """The function that was kept, None where there is none, or this process cannot run it."""
    try:
        content = b"" if path is None else path.read_bytes()
    except OSError:
        return None
    written, _, rest = content.partition(LISTED)
    # Nothing but what is whole is linked.
    return _linked(content) if hashlib.sha256(rest).hexdigest().encode() == written else None


@contextlib.contextmanager
def _alone(path: Path | None) -> Iterator[None]:
    """Compile while no other process compiles the same; where files cannot be locked, at once."""
    with contextlib.ExitStack() as stack:
        if path is not None and fcntl is not None:
            with contextlib.suppress(OSError):
                fcntl.flock(stack.enter_context(path.with_suffix(".lock").open("w")), fcntl.LOCK_EX)
        yield


def _write(path: Path, content: bytes) -> None:
    """Whole or not at all; another process may write the same."""
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(content)
        os.replace(file.name, path)
    except OSError as error:
        warnings.warn(
            f"compiled code could not be kept in {path.parent} ({error.strerror}): the next start compiles it again",
            RuntimeWarning,
            stacklevel=2,
        )


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
    return ctypes.CFUNCTYPE(None, *[ctypes.c_int64] * int(count))(engine.get_function_address(symbol.decode()))
