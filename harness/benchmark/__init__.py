"""The bench, and every other measurement behind a number that the documentation states.

`rockcheck bench` is `run.py`: run time against error (`precision.py`), what a target takes (`cover.py`), what each skip gains
(`skips.py`, `alone.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead (`others.py`, which asks
`analytic_model.py`, `start.py` and `contact_engines.py`). Measured apart, each by `python -m harness.benchmark.NAME`:
`memory` (what a thousand runs keep, creep at rest), `mutants` (known faults, of `faults.py`, that the comparator must find),
`paper_forms` (what the paper's misprints and simplifications change), `profiles` (bases of many vertices), `rattles` (swings of
some milliseconds) and `scoring` (what scores cost). Whether a stated uncertainty is honest is measured by
`python -m harness.coverage`.
"""
