"""What the pages may cost and how exactly they must show their records."""

from typing import Final

PAGE_BYTES: Final = 1_200_000
"""Of the page of a run with a replay: 1.03 MB are measured; a sixth more for another mesh."""

DRAWN_RAD: Final = 4e-6
"""Curves are stored in steps of 2⁻¹⁸ of their range: half of one is 3.8e-6 where they reach 2 rad."""

POSE_M: Final = 1e-12
"""Poses are rotations of points within 10 m in double precision: some 10 roundings of 1e-16 × 10 m."""

FRAME_MS: Final = 10.0
"""Script time per frame that leaves six milliseconds of the sixteen at 60 Hz for drawing."""

CONTRAST: Final = 4.5
"""Least contrast of text (WCAG 2.1, AA)."""

STILL_PX: Final = 0.06
"""Places in a still picture are written to 0.1 px."""

ROUNDED_INCH: Final = 5e-4
"""Sizes on paper are written to a hundredth of a millimetre and of a point."""

SAMPLED_M: Final = 1e-4
"""What samples of 1 ms miss of a place: at 0.3 g less than 1e-6 m, and a step of a contact engine some 1e-5."""
PUSH: Final = 1e-12
"""Pushes are quotients of lengths in double precision."""

SHADOW_SHARE: Final = 1.0 / 400.0
"""The outline leaves out bends below 1/800 of the height, at each of its two ends."""

PUSH_TOLD: Final = 6e-3
"""Pushes are told to three digits, of which the last is half a unit off: at most 5e-3 of a push told as 1.00; a fifth more."""

LEAN_TOLD: Final = 0.051
"""Leans are told to two digits: at most half a unit of the second, 5 % of 1.0; the share of the balance to two digits, too."""

LEAST_MOVES: Final = 2e-3
"""The least amplitude that moves a statue is rounded up in its fourth digit, 1e-3 of 1.000; twice that below it it rests."""

CALLS_TO_A_STEP: Final = 13
"""From the command to a step: command, scene, all engines (a function of their own: what has finished outlives an interrupt), one
engine, its accuracy, one run; an engine's own parts as many."""

CALLS_TO_A_VERIFYING_STEP: Final = 14
"""A run that only asks how a slightly stronger motion would move the statue passes one call more."""

CALLS_AROUND_AN_EVENT: Final = 19
"""Where an event is sought between two whole steps: what is due, its search, a step's two clocks and its friction are between."""

WRITTEN_PX: Final = 0.15
"""A picture's places are written with one decimal, so a difference of two of them is off by up to 0.1 along x and along y."""

SENTENCE_WORDS_MEAN: Final = 12.0
"""Plain-language guides (Cutts; the European Commission's) ask for 15 to 20 words a sentence on average; here less."""

PAGE_WORDS = 1200
"""Words of a run's page beside its tables, lists of values and drawings: five minutes of a reader at 240 words a minute."""
SENTENCE_WORDS_MOST: Final = 30
"""The same guides count a sentence of more than 30 words as one that is read twice."""

GULPEASE: Final = 65.0
"""Lucisano and Piemontese's index of words and sentences, 0 to 100: from 60 on readers with eight years of school read easily."""

BASE_M: Final = 1e-5
"""The page's mesh keeps single precision, 1e-7 of 1.5 m; the footprint leaves out corners that lie 1e-6 m from a side."""

LEAST_OF_LINES = {"line": 2.3, "horizon": 1.7}
"""Contrast of a thin line of a trust map with what it runs over: lines have dashes of their own, and a key; half of what a text
needs. That of the horizon ends where nothing is confirmed; it is weakest over red, which no map has shown yet."""

DRAWN_SHARE: Final = 1e-3
"""Of a curve's range, how far what is drawn may lie from its samples: a third of a pixel of a row of 320. The page leaves out
what lies within a quarter of this of its lines."""
