"""The bench and the stress run: what a run costs and errs by, and where engines stop being right.

`rockcheck bench` is `bench_run.py`: run time against error (`precision.py`), what a target takes, what skips gain
together and alone (`skips.py`), how cost grows (`scaling.py`). `rockcheck stress` is `stress_run.py`: stability maps and
hard scenes (`hard_scenes.py`). Both are measured in parts (`parts.py`). What stands beside other projects' programs, or
holds the whole to its claims, is measured in the source tree (`make bench`, `make stress`). Nothing else in the harness
imports this room.
"""
