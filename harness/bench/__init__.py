"""The bench, and every other measurement behind a number that the documentation states.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes (`uncertainty_coverage.py`),
what each skip gains (`skips.py`, `skip_savings.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead
(`other_integrators.py`, which asks `analytic_model.py`, `start.py` and `contact_engines.py`). Measured apart, each by
`python -m harness.bench.NAME`: `memory` (what a thousand runs keep, creep at rest), `mutants` (known faults, of `faults.py`, that
the comparator must find), `paper_forms` (what the paper's misprints and simplifications change), `profiles` (bases of many
vertices), `micro_rocking` (half-cycles of some milliseconds), `scoring` (what scores cost), `unchanged` (what each skip changes),
`random_scenes` and `coverage` (whether a stated uncertainty is honest), `pybullet_settings`, `pybullet_levels` and
`pybullet_shapes` (how pybullet's contact was settled). Nothing else in the harness imports this room.
"""
