"""The paper's figures 2 to 5 from our own flights, in its layout: one module a figure, one PNG each.

flights on disk ─> moments (a frame of each, with what the chain made of it) ─> a figure ─> PNG
"""
