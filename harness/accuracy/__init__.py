"""A target accuracy instead of a step: refinement, stated uncertainty, the horizon of prediction."""
