"""Thousands of recordings, below a folder or an object-store prefix: one row each, in one table."""
