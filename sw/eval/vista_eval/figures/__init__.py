"""Figures 2 to 5 of the paper, drawn from rendered flights; one module for each figure.

flights on disk ─> moments (a frame of each, with what the chain made of it) ─> a figure ─> PNG
"""
