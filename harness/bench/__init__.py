"""The bench and the stress run: what a run costs and errs by, and where engines stop being right.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes (`coverage.py`), what skips gain
together and alone (`skips.py`, `skip_savings.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead
(`other_integrators.py`, by a process of the source tree: `source_tree.py`); `sentences.py` says it in words. Both engines with
their own defaults are `pymunk_defaults.py` and `pybullet_defaults.py`. `rockcheck stress` is `stress/`. By hand: `python -m
harness.bench.coverage` (whether a stated uncertainty holds). What stands beside other projects' programs, renews a table of the
documentation or holds the whole to its claims is in `tests/measures`. Nothing else in the harness imports this room.
"""
