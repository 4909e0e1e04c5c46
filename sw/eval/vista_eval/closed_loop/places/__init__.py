"""Worlds that others defined, rebuilt from their published numbers, and an urban set.

What differs from the originals is said in each module, and in doc/closed-loop.md."""
