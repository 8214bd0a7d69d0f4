"""Many scenes, several engines: what varies, which runs are needed, the store that keeps them, and what their record says."""
