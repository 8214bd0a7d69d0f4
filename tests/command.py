"""The command as tests call it: in this process, with what it prints and how it ends."""

from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path

from reports.cli import app
from reports.cli.app import guarded


@dataclass(frozen=True)
class Done:
    """How a call of the command ended."""

    returncode: int
    stdout: str
    stderr: str


def rockcheck(*words: str, cwd: Path) -> Done:
    """Call the command in a folder; what it imports and inherits only a process of its own shows."""
    out, err = StringIO(), StringIO()
    with chdir(cwd), redirect_stdout(out), redirect_stderr(err):
        try:
            code = guarded(lambda: app(list(words)))
        except SystemExit as ending:
            code = int(ending.code or 0)
    return Done(code, out.getvalue(), err.getvalue())
