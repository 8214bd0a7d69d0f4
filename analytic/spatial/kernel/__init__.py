"""All of the model in three dimensions that is compiled."""
