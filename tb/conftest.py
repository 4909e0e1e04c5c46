"""Puts what the benches share on the path and names what is missing to run them."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent / "common"), str(Path(__file__).parents[1] / "model")]
