"""Flights in the loop: what the cameras show decides what is flown, and that decides what they show next.

    world ─> camera ─> detector ─> pilot ─> vehicle ─> collision ─> record, film, page

The chain is the one that ships. The worlds, the vehicle and what flies beside the planner are of this
package. Frames of reference are those of `vista_eval.render`: world z up, body forward, left, up.
"""
