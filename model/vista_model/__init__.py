"""The stereo engine in numpy: the contract, doc/design/engine-contract.md, in executable form."""

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
