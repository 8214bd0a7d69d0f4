"""A convex decomposition in a process of its own: `python -P coacd_alone.py IN.npz OUT.npz`; knows nothing of the project.

CoACD is C++ that some closed meshes bring down with a segmentation fault, and everything that runs in its process with it.
"""

import sys

import numpy as np


def main(given: str, wanted: str) -> None:
    """Decompose the mesh in one file with the options beside it, and write the corners of its parts and their counts."""
    import coacd

    with np.load(given) as arrays:
        mesh = coacd.Mesh(arrays["vertices_m"], arrays["faces"])
        concavity, max_parts, seed = arrays["options"]
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        mesh,
        threshold=float(concavity),
        max_convex_hull=int(max_parts),
        preprocess_mode="off",  # the mesh is closed already; remeshing would move its surface
        resolution=500,
        mcts_iterations=50,
        mcts_nodes=10,
        mcts_max_depth=2,
        seed=int(seed),
    )
    corners = [np.asarray(points, dtype=float).reshape(-1, 3) for points, _ in parts]
    np.savez(
        wanted, corners=np.vstack([np.zeros((0, 3)), *corners]), counts=np.array([len(each) for each in corners], int)
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
