"""Evaluation of VISTA on rendered flights with exact truth. The product, `vista`, does not import it."""
