"""From a scene's file to the scene that engines see, and to a first file from a scan and a record.

`tables.py` says what a user may write, `mistakes.py` tells what was wrong and where, `load.py` reads what the file names and
reconciles its numbers, `mesh_statue.py` turns a scan into a statue, `new_scene.py` writes a first scene.
"""
