"""Tolerances of the motion tests, each with the sentence that derives it."""

from typing import Final

CSV_DIGITS: Final = 5.001e-5
"""The CSVs of the data folder print four decimals of m/s², but never more than five digits: half of the last one, absolute
or relative."""

STATED_VELOCITY: Final = 0.01
"""The networks integrate before they filter and decimate, and print three digits: their peak velocity agrees to 1 %."""

SAME_MOTION: Final = 1e-12
"""The same sums in another order, relative to the peak."""

WRITTEN_DIGITS_G: Final = 1e-7
"""The synthetic AT2 files are written with seven decimals of g."""

NIGAM_JENNINGS: Final = 1e-7
"""Two exact recurrences on the same samples differ by rounding, and by eqsig's 2π of eight digits (3e-9, amplified by a few
tens of cycles)."""

PEAK_BETWEEN_SAMPLES: Final = 0.0124
"""At 20 samples in a period the peak between two samples is missed by 1 − cos(π/20) = 1.23 %."""

EQSIG_MISFIT: Final = 0.10
"""The promise: within 10 % of the target between 0.05 and 2 s."""

RETURN_TO_REST_M_S: Final = 1e-12
RETURN_TO_REST_M: Final = 1e-10
"""Sums of a few thousand terms of order 1 round at 1e-16 each; displacement adds their sum over the duration."""

CODE_TABLE: Final = 6e-4
"""The codes' tables print three or four digits."""

FLOOR_LINES: Final = 2e-3
"""Straight lines with 70 points in a period miss a sine by (2π/70)²/8 = 0.1 %; twice that for a peak between samples."""

STEADY_STATE: Final = 2e-3
"""After ten decay times the transient is e⁻¹⁰ of the peak; the rest is FLOOR_LINES."""

FILTER_PASS: Final = 1e-3
"""A Butterworth of order 4 run both ways at four times its corner: |H|² = 1/(1 + 4⁻⁸) is within 2e-5; edges add the rest."""

FILTER_STOP: Final = 5e-3
"""At a quarter of the corner |H|² = 1/(1 + 4⁸) = 1.5e-5; what remains are the window's edges."""

LIKENESS: Final = 0.5
"""An unrelated motion of 30 s and 10 Hz correlates with the record by about 1/√600 = 0.04: half is that earthquake still."""

MATCHING_PASSES: Final = 24
"""El Centro takes 9 to 17 wavelet passes to either limit state: half as many again is a loss of convergence."""

HEADER_PEAK: Final = 1e-3
"""The promise: a record's largest value is its header's to 0.1 %, most of which are the header's four digits."""

HEADER_DIGITS: Final = 1.3e-4
"""Headers give a peak with five digits or more, K-NET with four: half of the last one of 4.078 gal is 1.23e-4 of it."""

COUNTS_M_S2: Final = 0.5 * 2000.0 / 8388608 / 100.0 * 1.05
"""Half a count of K-NET's scale; the mean of 400 roundings adds 0.29/√400 = 0.015 counts, three of its deviations 9 % of half a
count at most and 5 % in these waves."""

TENTH_G_3: Final = 0.501e-3 * 0.1 * 9.80665
"""Three decimals of g/10: half of the last one."""

GAL_6: Final = 0.501e-6 * 0.01
GAL_3: Final = 0.501e-3 * 0.01
"""Six or three decimals of gal: half of the last one."""

SINGLE_PRECISION_M_S2: Final = 3e-9
"""SAC holds numbers of 24 bits: 2⁻²⁴ of the largest, 0.041 m/s², is 2.4e-9."""

RATE_DIGITS = 1e-6
"""A step of 1/128 s is 0.0078125: a clock keeps nine decimals, seven digits of the shortest step."""

CLOCK_S = 1e-6
"""Seconds since 1970 in doubles: 2e-7 s apart in 2010."""
