"""Will it keep up? A system from camera to obstacle map, simulated in time by model/systemc.

options, preset ─> SystemConfig ─> simulate ─> Run ─> figures ─> table, JSON
synthesis: placed-and-routed clocks ─┘   └─ host_times: the host's stages, measured here
                                         explore: what limits it, clock needed, sweeps ─> plots ─> report
"""
