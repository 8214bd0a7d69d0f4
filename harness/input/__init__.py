"""What a user hands in: scene files, meshes, motions, histories of other software; read, checked, resolved."""
