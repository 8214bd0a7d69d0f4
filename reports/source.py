"""A result folder as the pages read it: the record, its histories and its mesh; nothing is computed anew."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

from jinja2 import UndefinedError

from harness.input.history_file import read_history
from harness.model.errors import InputError, Mistake
from harness.model.history import History, history_file
from harness.records.base import REWRITE, Record
from harness.records.kinds import read_result
from harness.records.result_folder import RECORD, as_written, owned
from harness.records.run import EngineRunRecord, RunRecord
from harness.records.scene import SceneRecord

DAMAGE: Final = (LookupError, TypeError, ValueError, AttributeError, ArithmeticError, StopIteration, UndefinedError)


@dataclass(frozen=True, eq=False)
class RunSource:
    """The record of one run with the histories that it names; `mesh` is the statue's mesh file, None without one."""

    folder: Path
    record: RunRecord
    histories: Mapping[str, History]
    mesh: Path | None

    @property
    def scene(self) -> SceneRecord:
        """The resolved scene."""
        return self.record.scene

    @property
    def runs(self) -> Mapping[str, EngineRunRecord]:
        """All engines' answers by name."""
        return self.record.runs


def kind_of(record: Record | Mapping[str, Any]) -> str:
    """The kind of a record."""
    return record.kind if isinstance(record, Record) else str(record["kind"])


@contextmanager
def naming_damage(folder: Path, record: Record | Mapping[str, Any], page: str = "") -> Iterator[None]:
    """Turn what a page meets where a part of a record without a class is absent or of another form into an `InputError`.

    A record that has a class was validated when it was read: what a page trips over there is its own fault, and is seen as one.
    """
    if isinstance(record, Record):
        yield
        return
    try:
        yield
    except InputError:
        raise
    except DAMAGE as error:
        came = f"{type(error).__name__}: {error}"
        advice = f"{REWRITE}; if it comes again, it is a fault of rockcheck: please report it"
        wanted = f"a whole record for {page}" if page else "a whole record"
        raise InputError(Mistake(str(folder / RECORD), "", wanted, came, advice)) from error


def run_source(folder: Path) -> RunSource:
    """The record of a run and its histories; raises `InputError` for a damaged folder, or one of another kind."""
    record = read_result(folder)
    if not isinstance(record, RunRecord):
        raise InputError(Mistake(str(folder / RECORD), "kind", "run", repr(kind_of(record))))
    return source_of(folder, record)


@lru_cache(maxsize=1)
def source_of(folder: Path, record: RunRecord) -> RunSource:
    """The record of a run with what lies beside it, read once for all pages; raises `InputError` where that is lost."""
    # Records of older versions do not say which histories they kept: what lies there is all.
    names = record.runs if record.histories is None else record.histories
    paths = {name: folder / history_file(name) for name in names}
    lost = [path for path in paths.values() if record.histories is not None and not path.is_file()]
    mesh = folder / "statue.glb"
    if record.scene.statue.mesh is not None and not mesh.is_file():
        lost.append(mesh)
    if lost:
        raise InputError(
            [Mistake(str(path), "", "the file that result.json names", "none there", REWRITE) for path in lost]
        )
    sums = owned(folder)
    changed = [path for path in (*paths.values(), mesh) if path.is_file() and not as_written(path, sums)]
    if changed:
        wanted = "the file that result.json lists"
        raise InputError([Mistake(str(path), "", wanted, "another content", REWRITE) for path in changed])
    histories = {name: read_history(path) for name, path in paths.items() if path.is_file()}
    return RunSource(folder, record, histories, mesh if mesh.is_file() else None)
