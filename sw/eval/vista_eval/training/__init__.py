"""What `vista train` learns: how much each piece of evidence says that a place on the path is occupied, and
what weights of affinities are worth.

flight ─> evidence (the detector's places, with the truth of each) ─> logistic ─> odds (a header of C)
flight ─> affinity (pairs of neighbouring cells, with the truth of each) ─> logistic ─> a table
"""
