"""The command `rockcheck`: the application, its options, what each command does, how it ends."""

import gc
import os
import sys
from io import TextIOWrapper

from reports.cli import commands
from reports.cli.app import app, guarded

__all__ = ["app", "commands", "main"]


def main() -> None:
    """Entry point of the command."""
    # What is imported lives to the end: to look through it every 700 objects takes a tenth of a start.
    gc.set_threshold(100_000)
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
