"""Throughput of a whole system, from the camera to the obstacle map, simulated in time by model/systemc.

options, preset ─> SystemConfig ─> simulate ─> Run ─> figures ─> table, JSON
synthesis: placed-and-routed clocks ─┘   └─ host_times: the host's stages, measured here
                                         explore: what limits it, clock needed, sweeps ─> plots ─> report
"""
