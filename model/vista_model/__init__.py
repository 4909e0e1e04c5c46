"""The stereo engine in numpy: the contract, doc/design/engine-contract.md, in executable form."""

from vista_model.engine import (
    INVALID,
    NO_CONFIDENCE,
    NO_COST,
    Parameters,
    compute,
    compute_all,
    compute_with_smin,
)
from vista_model.frontend import compute_levels, pyramid, reduce, smooth
from vista_model.rectify import grid_shape, rectify, row_beyond, sources

__all__ = [
    "INVALID",
    "NO_CONFIDENCE",
    "NO_COST",
    "Parameters",
    "compute",
    "compute_all",
    "compute_levels",
    "compute_with_smin",
    "grid_shape",
    "pyramid",
    "rectify",
    "reduce",
    "row_beyond",
    "smooth",
    "sources",
]
