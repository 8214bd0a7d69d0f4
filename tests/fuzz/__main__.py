"""`python -m tests.fuzz [FIRST LAST]` uses mutated files and prints a row of JSON for each kind; 3 where one did harm.

Input n is of kind n modulo their number, with n over that as its seed; without numbers all of a stress run's.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence

from harness.questions.bench.stress.stress_run import HARM, INPUTS
from tests.fuzz.fuzz_run import rows


def main(arguments: Sequence[str]) -> int:
    """Print the rows as they are found."""
    first, last = (int(item) for item in arguments) if arguments else (0, INPUTS - 1)
    harm = False
    for row in rows(first, last):
        harm = harm or bool(row["found"])
        sys.stdout.write(json.dumps(row) + "\n")
        sys.stdout.flush()
    return HARM if harm else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
