"""The bench, and every other measurement behind a number that the documentation states.

`rockcheck bench` is `run.py`: run time against error (`precision.py`), what a target takes (`cover.py`), what each skip gains
(`skips.py`, `alone.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead (`others.py`, which asks
`analytic_model.py`, `start.py` and `contact_engines.py`). Measured apart, each by `python -m harness.benchmark.NAME`:
`memory` (what a thousand runs keep, creep at rest), `mutants` (known faults that the comparator must find), `profiles` (bases
of many vertices), `scoring` (what scores cost).
"""
