"""The statue drawn: where it is at a rotation, its outline, its replay."""
