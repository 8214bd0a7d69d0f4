"""What a user is told when the input is wrong: every mistake at once, each with its place."""

import json
import re
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Final, TypeVar

T = TypeVar("T")
K = TypeVar("K")

# A user's own text on a terminal and on a page: what would steer either is shown as its escape instead.

CONTROL: Final = re.compile("[\x00-\x1f\x7f-\x9f\u200e\u200f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""C0 and C1 controls (ECMA-48), line and direction marks (Unicode UAX 9 and 14), bytes of a file name that are no UTF-8."""


def printable(text: str) -> str:
    """The text on one line, each control character as its escape (`\\x1b`, `\\n`)."""
    return CONTROL.sub(lambda mark: mark.group().encode("unicode_escape").decode("ascii"), text)


def printable_lines(text: str) -> str:
    """The text with its lines kept, each of them printable."""
    return "\n".join(map(printable, text.split("\n")))


def json_text(value: Any) -> str:
    """Indented JSON that is readable in its own language and carries no control character as it stands."""
    text = json.dumps(value, indent=1, ensure_ascii=False)
    return "\n".join(CONTROL.sub(lambda mark: f"\\u{ord(mark.group()):04x}", line) for line in text.split("\n"))


LONGEST = 1000
"""Characters of what came that are shown."""


@dataclass(frozen=True)
class Mistake:
    """One mistake in the user's input.

    `where` is the file (or command-line option), `key` the dotted key, line or column in it, `wanted` and `got` finish the
    sentence "wanted …, got …", `advice` says what to do.
    """

    where: str
    key: str
    wanted: str
    got: str
    advice: str = ""

    def __str__(self) -> str:
        place = f"{self.where}: {self.key}" if self.key else self.where
        got = self.got if len(self.got) <= LONGEST else f"{self.got[:LONGEST]}… ({len(self.got)} characters)"
        text = f"{place}: wanted {self.wanted}, got {got}"
        return printable(f"{text} — {self.advice}" if self.advice else text)


def nearest(name: str, known: Iterable[str]) -> str:
    """The advice for a name that is not known: the nearest of those that are; "" where none is near."""
    # Needed for a mistake only: who makes none does not load it.
    from difflib import get_close_matches

    near = get_close_matches(name, list(known), n=1)
    return f"did you mean {near[0]}?" if near else ""


class InputError(ValueError):
    """The user's input is wrong; carries all mistakes found (the command prints them and exits with 2)."""

    def __init__(self, mistakes: Mistake | Iterable[Mistake]) -> None:
        self.mistakes: tuple[Mistake, ...] = (mistakes,) if isinstance(mistakes, Mistake) else tuple(mistakes)
        super().__init__(self.mistakes)  # what a worker sends back is made again of this

    def __str__(self) -> str:
        return "\n".join(map(str, self.mistakes))


def refuse(mistakes: Collection[Mistake]) -> None:
    """Raise `InputError` of all these mistakes, where there is one."""
    if mistakes:
        raise InputError(mistakes)


def read_each(read: Callable[[T], K], items: Iterable[T]) -> list[K]:
    """What each item is read as. Raises one `InputError` with the mistakes of all of them, each once."""
    found: list[K] = []
    mistakes: dict[Mistake, None] = {}
    for item in items:
        try:
            found.append(read(item))
        except InputError as error:
            mistakes |= dict.fromkeys(error.mistakes)
    refuse(mistakes)
    return found


def require(holds: object, where: str, wanted: str, got: str, advice: str = "", *, key: str = "") -> None:
    """Raise `InputError` of one mistake unless something holds."""
    if not holds:
        raise InputError(Mistake(where, key, wanted, got, advice))


def required(value: T | None, where: str, wanted: str, got: str, advice: str = "", *, key: str = "") -> T:
    """The value, which is not None; else raises `InputError` of one mistake."""
    if value is None:
        raise InputError(Mistake(where, key, wanted, got, advice))
    return value


@contextmanager
def translated(
    kinds: type[Exception] | tuple[type[Exception], ...],
    where: str,
    wanted: str,
    got: str = "",
    advice: str = "",
    *,
    key: str = "",
) -> Iterator[None]:
    """Raise errors of these kinds as `InputError` of one mistake; what came is `got`, or what the error says."""
    try:
        yield
    except kinds as error:
        raise InputError(Mistake(where, key, wanted, got or str(error), advice)) from error


def check_known(name: str, known: Collection[str], option: str) -> None:
    """Raise `InputError` for what an option names that is none of the known; the nearest is advised."""
    if name not in known:
        raise InputError(Mistake(option, "", f"one of {', '.join(known)}", repr(name), nearest(name, known)))
