"""One scene, several models, one comparison."""
