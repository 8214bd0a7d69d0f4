"""Runs put into a store, and what SQLite says of its file."""

from collections.abc import Sequence

from harness.model import Run
from harness.runs.store import Store, packed
from harness.runs.task import answer_of


def put(store: Store, results: Sequence[tuple[str, Run]], histories: bool = False) -> None:
    """Store finished runs, each in a transaction of its own."""
    for key, run in results:
        store.add([packed(key, answer_of(run, histories))])


def is_sound(store: Store) -> bool:
    """Whether SQLite finds no fault in the store's file."""
    return bool(store._db.execute("PRAGMA quick_check(1)").fetchone()[0] == "ok")
