"""Puts what the benches share on the path and names what is missing to run them."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
# cocotb hands sys.path on to the simulation.
sys.path[:0] = [
    str(p) for p in (HERE / "common", HERE / "units", HERE.parent / "model", HERE.parent / "build/python")
]
