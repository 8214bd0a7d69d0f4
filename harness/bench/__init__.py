"""The bench and the stress run: what a run costs and errs by, and where engines stop being right.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes (`coverage.py`), what skips gain
together and alone (`skips.py`, `skip_savings.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead
(`other_integrators.py`, which asks `analytic_model.py`, `start.py` and `contact_engines.py`); `sentences.py` says it in words.
Both engines with their own defaults are `pymunk_defaults.py` (with the baseline loop) and `pybullet_defaults.py`.
`rockcheck stress` is `stress/`. By hand: `python -m harness.bench.coverage` (whether a stated uncertainty holds). Commands that
renew a table of the documentation, and what holds the whole to its claims, are in `tests/measures`. Nothing else in the harness
imports this room.
"""
