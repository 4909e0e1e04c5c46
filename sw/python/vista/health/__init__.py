"""Checks that a run makes of its own input: whether what the cameras show and the poses say can be trusted.

finding   what a check gives, and the health of a frame that follows from it
features  features of one image that are found again in another
checks    the checks, each a function of what it judges
monitor   calls the checks for every frame of a run
summary   what a whole run has found
"""
