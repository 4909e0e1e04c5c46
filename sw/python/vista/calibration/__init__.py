"""Calibration of a pair of cameras from pictures of a board, and calibration files of other programs."""
