"""Whether a process is still there."""

import time
from pathlib import Path

PATIENCE_S = 10.0
"""A process that is ending has ended by then, however busy the machine."""


def ended(pid: int) -> bool:
    """Whether the process is gone (or only waits to be counted) within a short time."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        try:
            if "State:\tZ" in Path(f"/proc/{pid}/status").read_text():
                return True
        except (FileNotFoundError, ProcessLookupError):
            return True
        time.sleep(0.02)
    return False
