"""The bench, and the scripts that settled a constant or say how far a stated uncertainty can be trusted.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes (`coverage.py`), what skips gain
together and alone (`skips.py`, `skip_savings.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead
(`other_integrators.py`, which asks `analytic_model.py`, `start.py` and `contact_engines.py`); `sentences.py` says it in words.
Both engines with their own defaults are `pymunk_defaults.py` (with the baseline loop) and `pybullet_defaults.py`.
`rockcheck stress` is `stress/`. By hand, each by `python -m harness.bench.NAME`: `coverage`, `random_scenes`, `plain_scenes` and
`space_scenes` (whether a stated uncertainty holds), `calibration` (whether probabilities are true), all but the first on
`seeded_rows.py`; `pybullet_settings`, `pybullet_levels` and `plain_levels` (how contacts were settled, and what each level errs
by). What holds the whole to its claims is in `tests/measures`. Nothing else in the harness imports this room.
"""
