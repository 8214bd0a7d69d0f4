"""A record said in words, numbers and rows."""
