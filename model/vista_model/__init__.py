"""The stereo engine's contract in numpy: model/README.md is the text, these modules its executable form."""

from vista_model.engine import INVALID, NO_COST, Parameters, compute, compute_with_smin
from vista_model.frontend import compute_levels, pyramid, reduce, smooth

__all__ = [
    "INVALID",
    "NO_COST",
    "Parameters",
    "compute",
    "compute_levels",
    "compute_with_smin",
    "pyramid",
    "reduce",
    "smooth",
]
