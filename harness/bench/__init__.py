"""The bench and the stress run: what a run costs and errs by, and where engines stop being right.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes (`coverage.py`), what skips gain
together and alone (`skips.py`, `skip_savings.py`), how cost grows (`scaling.py`), and other integrators, starts, overhead
(`other_integrators.py`); `sentences.py` says it in words. `rockcheck stress` is `stress/`.

What holds the whole to its claims, stands beside other projects' programs or renews a table of the documentation is in
`tests/measures`; parts that rest on it ask it by a process of the source tree (`source_tree.py`). Nothing else in the harness
imports this room.
"""
