"""Where the command begins: an interrupt while its parts are still being read ends it as it does later."""

import sys
from typing import Final

INTERRUPTED: Final = 130
"""As `reports.cli.app` has it, which may not have been read yet."""


def main() -> None:
    """Entry point of the command."""
    try:
        from reports.cli import main as begin
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)
    begin()
