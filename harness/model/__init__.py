"""The nouns: what is run, what is asked, what is answered, what a user did wrong; each is loaded when first asked."""

from importlib import import_module
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from harness.model.errors import (
        CONTROL,
        LONGEST,
        InputError,
        Mistake,
        check_known,
        json_text,
        nearest,
        printable,
        printable_lines,
        read_each,
        refuse,
        require,
        required,
        translated,
    )
    from harness.model.files import FRESH, MARK, NO_ROOM, check_own, checksum, is_own, is_sealed, write_text, writing
    from harness.model.finding import (
        Answer,
        Axes,
        Finding,
        Say,
        Severity,
        Shown,
        caution,
        changes_answer,
        info,
        new_axes,
        texted,
        weighed,
    )
    from harness.model.history import (
        COLUMNS,
        Array,
        History,
        Outcome,
        Pair,
        first_beyond_s,
        hermites,
        history_file,
        output_grid,
        pair,
    )
    from harness.model.run import (
        MANY,
        MOST_TIMES,
        NUMBERS,
        OMITTED,
        RUN_FIELDS,
        SAME_END,
        SCHEMA_VERSION,
        SKIPS,
        Capabilities,
        Intervention,
        Pattern,
        PatternName,
        Run,
        RunOptions,
        RunRow,
        machine,
        number,
        to_plain,
        versions,
        write_json,
    )
    from harness.model.run_set import Column, RunSet, answered, column_of, grouped
    from harness.model.scene import (
        OVERTURN_RAD,
        SOLID_COLUMNS,
        BaseExcitation,
        Contact,
        Form,
        Initial,
        Pedestal,
        Pose,
        Scene,
        Statue,
        Uncertain,
        Wall,
        centroid_shift_m,
        must_be_scene,
        rotations,
        scan_azimuth_deg,
        support_m,
        written,
    )
    from harness.model.two_block import base_end, block_of, keywords, pedestal_of, wall_of

_NAMES: Final = {
    "errors": (
        "CONTROL LONGEST InputError Mistake check_known json_text nearest printable printable_lines read_each "
        "refuse require required translated"
    ),
    "files": "FRESH MARK NO_ROOM check_own checksum is_own is_sealed write_text writing",
    "finding": "Answer Axes Finding Say Severity Shown caution changes_answer info new_axes texted weighed",
    "history": "COLUMNS Array History Outcome Pair first_beyond_s hermites history_file output_grid pair",
    "run": (
        "MANY MOST_TIMES NUMBERS OMITTED RUN_FIELDS SAME_END SCHEMA_VERSION SKIPS Capabilities Intervention "
        "Pattern PatternName Run RunOptions RunRow machine number to_plain versions write_json"
    ),
    "run_set": "Column RunSet answered column_of grouped",
    "scene": (
        "OVERTURN_RAD SOLID_COLUMNS BaseExcitation Contact Form Initial Pedestal Pose Scene Statue Uncertain "
        "Wall centroid_shift_m must_be_scene rotations scan_azimuth_deg support_m written"
    ),
    "two_block": "base_end block_of keywords pedestal_of wall_of",
}
"""The names by their modules."""
_HOMES: Final = {name: home for home, names in _NAMES.items() for name in names.split()}
__all__ = [
    "COLUMNS",
    "CONTROL",
    "FRESH",
    "LONGEST",
    "MANY",
    "MARK",
    "MOST_TIMES",
    "NO_ROOM",
    "NUMBERS",
    "OMITTED",
    "OVERTURN_RAD",
    "RUN_FIELDS",
    "SAME_END",
    "SCHEMA_VERSION",
    "SKIPS",
    "SOLID_COLUMNS",
    "Answer",
    "Array",
    "Axes",
    "BaseExcitation",
    "Capabilities",
    "Column",
    "Contact",
    "Finding",
    "Form",
    "History",
    "Initial",
    "InputError",
    "Intervention",
    "Mistake",
    "Outcome",
    "Pair",
    "Pattern",
    "PatternName",
    "Pedestal",
    "Pose",
    "Run",
    "RunOptions",
    "RunRow",
    "RunSet",
    "Say",
    "Scene",
    "Severity",
    "Shown",
    "Statue",
    "Uncertain",
    "Wall",
    "answered",
    "base_end",
    "block_of",
    "caution",
    "centroid_shift_m",
    "changes_answer",
    "check_known",
    "check_own",
    "checksum",
    "column_of",
    "first_beyond_s",
    "grouped",
    "hermites",
    "history_file",
    "info",
    "is_own",
    "is_sealed",
    "json_text",
    "keywords",
    "machine",
    "must_be_scene",
    "nearest",
    "new_axes",
    "number",
    "output_grid",
    "pair",
    "pedestal_of",
    "printable",
    "printable_lines",
    "read_each",
    "refuse",
    "require",
    "required",
    "rotations",
    "scan_azimuth_deg",
    "support_m",
    "texted",
    "to_plain",
    "translated",
    "versions",
    "wall_of",
    "weighed",
    "write_json",
    "write_text",
    "writing",
    "written",
]


def __getattr__(name: str) -> object:
    """Load one of the names; a command that needs no scene does not load numpy for an error's message."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    return value
