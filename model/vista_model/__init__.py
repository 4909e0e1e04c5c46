"""The stereo engine's contract in numpy: doc/design/engine-contract.md is the text, `engine` its executable form."""

from vista_model.engine import INVALID, NO_COST, Parameters, compute, compute_with_smin

__all__ = ["INVALID", "NO_COST", "Parameters", "compute", "compute_with_smin"]
