"""Records in, pages and figures out."""
