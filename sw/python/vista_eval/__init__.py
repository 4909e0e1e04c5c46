"""Evaluation of VISTA on rendered flights with exact truth; the product, `vista`, knows nothing of it."""
