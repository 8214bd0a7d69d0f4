"""What a scene needs before anything moves: limits of rest, symmetry, collision shapes, what is left out."""
