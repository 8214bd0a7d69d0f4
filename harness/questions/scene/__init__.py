"""One scene, several engines, one result folder."""
