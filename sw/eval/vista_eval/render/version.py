"""Which pictures the renderer makes. To be raised when they change: frames of another version are made anew.

A change of the renderer's code alone deletes no frames. The test sw/eval/tests/test_render_version.py notices
it and asks which of the two it is.
"""

RENDER_VERSION = 1  # of the paper's flights, by path tracing
FAST_RENDER_VERSION = 4  # of flights drawn by casting rays
