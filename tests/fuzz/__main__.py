"""`python -m tests.fuzz` uses mutated files and prints what came of each kind; 3 where one did harm.

`python -m tests.fuzz FIRST LAST` uses some of them in this process and prints a row of JSON for each kind. Input n is of kind n
modulo their number, with n over that as its seed.
"""

import json
import sys
from collections.abc import Sequence

from tests.fuzz.fuzz_run import rows
from tests.fuzz.pieces import HARM, summed, whole


def main(arguments: Sequence[str]) -> int:
    """Print the rows as they are found."""
    harm = False
    if arguments:
        first, last = (int(item) for item in arguments)
        for row in rows(first, last):
            harm = harm or bool(row["found"])
            print(json.dumps(row), flush=True)
    else:
        found = []
        for done in whole():
            found += done
            print(f"{sum(row['inputs'] for row in found)} inputs used", file=sys.stderr)
        for kind in summed(found):
            harm = harm or kind.harm > 0
            print(f"{kind.reader}: {kind.inputs} inputs, {kind.accepted} accepted and used, {kind.harm} did harm")
            for each in kind.found:
                print(f"  seed {each.seed}: {each.what}")
    return HARM if harm else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
