"""What the documents show of the command: its lines in their fenced `console` blocks, each held to what is printed now."""

import re
from collections.abc import Iterable

SECONDS = re.compile(r"  \d\S* m?s$")
"""The last column of an engine's row: what the run took, which differs from machine to machine."""


def shown(page: str) -> list[tuple[str, list[str]]]:
    """Every command of a page's `console` blocks, with the lines that stand below it."""
    found: list[tuple[str, list[str]]] = []
    for block in re.findall(r"```console\n(.*?)```", page, re.S):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            else:
                found[-1][1].append(line)
    return found


def not_printed(lines: Iterable[str], output: str) -> list[str]:
    """The shown lines that do not stand in the output, in their order; what a run took may be another."""
    left = iter([SECONDS.sub("", line.rstrip()) for line in output.splitlines()])
    return [line for line in lines if SECONDS.sub("", line.rstrip()) not in left]
