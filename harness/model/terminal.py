"""A user's own text on a terminal and on a page: what would steer either is shown as its escape instead."""

from __future__ import annotations

import json
import re
from typing import Any, Final

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
