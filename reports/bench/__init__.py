"""What pages and motions cost."""
