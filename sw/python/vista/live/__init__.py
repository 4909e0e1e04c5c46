"""Frames to obstacles while they come: a source, a queue of one frame, the chain, and what listens to it."""
