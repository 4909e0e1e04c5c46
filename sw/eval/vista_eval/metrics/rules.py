"""What a flight is judged by: one set of rules, with two named sets of limits.

PAPER   the paper's flights, which are straight: as they have been judged from the start
STRICT  sampled flights: where the aircraft really flies, what it really meets, and how far away that is
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Rules:
    name: str
    least_tolerance_m: float  # of a distance; 2 dz(r) where that is more
    inflation_m: float  # of the collision volume, within which a warning is no false alarm
    # The path is that of the true poses, not a straight line along the flight's travel; what is large or is
    # ground is judged by the point where the collision volume first meets it.
    meeting: bool
    before_impact_s: float | None  # a target is asked for no earlier than that before it is met

    def tolerance_m(self, depth_of_one_disparity_m: float) -> float:
        return max(2.0 * depth_of_one_disparity_m, self.least_tolerance_m)

    def band_m(self, closing_m_s: float) -> tuple[float, float]:
        """Nearest and farthest range at which a hit is asked for. A slow flight's band begins later; where
        little or nothing would be left of it, it ends later, too."""
        near_m, far_m = HIT_RANGE_M
        if self.before_impact_s is not None:
            far_m = min(far_m, self.before_impact_s * closing_m_s)
        return min(near_m, 0.5 * far_m), far_m


HIT_RANGE_M = (14.5, 45.0)
HIT_RANGE = f"{HIT_RANGE_M[0]:g} to {HIT_RANGE_M[1]:g} m"
NEAR = f"nearer than {HIT_RANGE_M[1]:g} m"  # where a frame may be missed

PAPER = Rules("paper", 2.0, 1.0, meeting=False, before_impact_s=None)
STRICT = Rules("strict", 0.5, 0.5, meeting=True, before_impact_s=3.0)

# How far a path is followed, as the host does by its defaults. Those may be tuned, the truth may not.
SPEED_MIN_M_S = 0.5  # slower, a camera stands
TURN_MIN_DEG_S = 1.0  # slower, a path is straight
CURVATURE_UNCERTAINTY = 0.25  # share of a path's curvature
