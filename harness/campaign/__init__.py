"""Where runs are computed: pools of processes or a cluster, one run alone in a process, and what a process that died had at work.

`executors.py` holds the pools, `batches.py` what studies and validations hand to them, `isolate.py` one run apart.
"""
