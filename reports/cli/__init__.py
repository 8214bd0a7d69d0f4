"""The command `rockcheck`: the application, its options, what each command does, how it ends."""

import gc
import os
import sys
from io import TextIOWrapper

# Each adds its commands, which the help lists in this order.
# isort: off
from reports.cli import scenes, questions, inputs
# isort: on

from reports.cli.app import app
from reports.cli.ending import guarded

__all__ = ["app", "inputs", "main", "questions", "scenes"]


def main() -> None:
    """Entry point of the command."""
    gc.set_threshold(
        100_000
    )  # what is imported lives to the end: to look through it every 700 objects takes a tenth of a start
    for name in ("stdin", "stdout", "stderr"):
        # Who starts the command may have closed it: the next file would take its number, and all that is printed.
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w"))  # noqa: SIM115
    if isinstance(sys.stdout, TextIOWrapper):
        # The name of a file may be no text: what cannot be printed is printed as escapes.
        sys.stdout.reconfigure(errors="backslashreplace")
    sys.exit(guarded(app))


if __name__ == "__main__":
    main()
