"""Flights and scenes scored against their exact truth.

    flight on disk -> fly (the chain) -> records ─┐
                   -> truth ──────────────────────┴> judge (a frame) -> flight (figures) -> table, report

Definitions, all in the true world frame, metres (dz(r) = r^2 / (f B), the depth of one disparity at range r):

flight path     from the left camera along the direction of the whole flight's travel (flights are straight)
cylinder        points within 2 m of the flight path and at most 100 m along it
true danger     world points of the exact disparity map within the cylinder
range           distance from the left camera
target          the object flown at; of several, the nearest with at least DANGER_PIXELS in the cylinder
P               of a compact target (no side above COMPACT_M): its own centre, the board's for sign and pole;
                of a large one: the mean of its points in the cylinder that are seen in this frame
warning         a confirmed obstacle that the map puts into the collision volume; coasting ones included
agrees          an obstacle with true points, if one of them lies at its bearing +- half its extent (at least
                BEARING_MARGIN_PX) and within max(2 dz(r), 2 m) of its range r; of something too near to match
                a warning gives the largest range that it may have, and any nearer point agrees
hit             a warning that agrees with the target, in a frame where that is a true danger at 14.5 to 45 m
missed frame    the target is a true danger nearer than 45 m, the blind zone included, and no warning agrees
false alarm     a warning that agrees with nothing: no point of any surface in the cylinder inflated by 1 m,
                as the frame's exact map shows it or, of what stands still, any other frame's: things narrower
                than a pixel miss the pixels' centres from afar.
                A ghost, if it agrees with no surface outside of that either; else something beside the path
begins          range in the flight's first frame, if a target is a true danger there. What is to be shown at
                a range is asked of flights that begin there or farther; the others are named beside it
warned from     range in the first frame with a warning that agrees with the target, if all but one of the
                next STAYS_FRAMES frames have one too: the first detection
tracked from    the same of any confirmed obstacle, in or out of the collision volume
match           the warning that agrees with the target and did so in the frame before; else the one nearest
                to P of those that agree (of a sign and of its pole both may be warned)
error           |P - P^| of the match; for a large target the distance of P^ to the nearest seen point of it,
                because it may be anywhere on a wall, and no NEES
blind frame     the target's nearest point in the cylinder is nearer than the engine matches,
                f B / (candidates - 1)

Sampled flights are judged by stricter limits (rules.STRICT); what differs:

flight path     leads through the true positions of the frames that follow, and goes on beyond the last one
                (flight_path). Something that moves is in the way if it and the aircraft will meet
met             the point that the collision volume touches first as it travels along the path (meeting); of
                ground, which lies below the image in the last second, also as earlier frames showed it
P               of what is thin or flat and no larger than COMPACT_M its own centre; of everything else, the
                ground included, the point where it is met
warning         the nearest collision has the position and the covariance that are reported as its own, the
                others have those of the obstacle
agrees          within max(2 dz(r), 0.5 m). A warning of what has no centre of its own has to give the range
                of P
match           of what is met, the nearest collision if it agrees; else as above. Only error and NEES are of
                the match: a hit is a hit whichever warning agrees, and all that agree with nothing are false
                alarms, so there is nothing to be gained by what is reported as the nearest collision
error           |P - P^| of every match, with a NEES: of what is met that of the distance along the line of
                sight alone, with one degree of freedom
hit             asked for at 14.5 to 45 m, or from 3 s before impact where that is shorter: then down to half
                of that, if that is nearer than 14.5 m
false alarm     likewise within max(2 dz(r), 0.5 m), and 0.5 m of the volume; ground agrees only with a
                warning that gives the range where it is met

How far the path and level directions are called free is judged apart from warnings (free_path,
free_directions).

Under pose noise an estimate is carried into the true world through the camera: what counts is where an
obstacle is as seen from the aircraft.
"""
