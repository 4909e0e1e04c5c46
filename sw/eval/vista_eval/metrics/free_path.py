"""How far the path is called free, against how far it is.

clear       nothing within the true path's cylinder for CLEAR_M, nor ground that is met there. Asked is that
            the path is called seen for SEEN_M
through     something is met within ASKED_M, nothing is warned of, and the path is called seen THROUGH_M
            beyond it or farther
too late    the aircraft can no longer stop, with BRAKING_M_S2, before something that is neither warned of
            nor unknown: the path is called seen as far as that
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from vista_eval.report.table import Table

CLEAR_M, SEEN_M = 45.0, 40.0
ASKED_M, THROUGH_M = 60.0, 2.0
BRAKING_M_S2 = 3.0


@dataclass(frozen=True)
class FrameOnPath:
    """The path of one frame: as it truly is, and as it is told."""

    contact_m: float  # infinite: nothing is met
    length_m: float  # as far as the true path is followed
    speed_m_s: float
    seen_m: float
    warned: bool
    healthy: bool

    @property
    def clear(self) -> bool:
        return self.length_m >= CLEAR_M and self.contact_m > CLEAR_M

    @property
    def asked(self) -> bool:
        return self.contact_m <= ASKED_M

    @property
    def through(self) -> bool:
        return self.asked and not self.warned and self.seen_m >= self.contact_m + THROUGH_M

    @property
    def too_late(self) -> bool:
        stopping_m = self.speed_m_s**2 / (2.0 * BRAKING_M_S2)
        return self.contact_m <= stopping_m and not self.warned and self.seen_m >= self.contact_m


@dataclass(frozen=True)
class FreePath:
    """Frames of one flight, or of several."""

    clear: int = 0
    clear_seen: int = 0
    asked: int = 0
    through: int = 0
    through_healthy: int = 0
    longest_through: int = 0  # in a row
    too_late: int = 0


def free_path(frames: Sequence[FrameOnPath]) -> FreePath:
    """frames: of one flight, in their order."""
    through = [frame for frame in frames if frame.through]
    runs = [len(list(run)) for called, run in groupby(frames, lambda frame: frame.through) if called]
    return FreePath(
        sum(frame.clear for frame in frames),
        sum(frame.clear and frame.seen_m >= SEEN_M for frame in frames),
        sum(frame.asked for frame in frames),
        len(through),
        sum(frame.healthy for frame in through),
        max(runs, default=0),
        sum(frame.too_late for frame in frames),
    )


def together(flights: Iterable[FreePath]) -> FreePath:
    flights = list(flights)
    totals = {
        name: sum(getattr(flight, name) for flight in flights) for name in FreePath.__dataclass_fields__
    }
    longest = max((flight.longest_through for flight in flights), default=0)
    return FreePath(**totals | {"longest_through": longest})


def table(of: str, paths: Sequence[tuple[str, FreePath]]) -> Table:
    """A row for each: a flight, or a family."""
    rows = [
        (
            name,
            f"{path.clear_seen}/{path.clear}" if path.clear else "",
            f"{path.through}/{path.asked}" if path.asked else "",
            str(path.through_healthy),
            str(path.longest_through),
            str(path.too_late),
        )
        for name, path in paths
    ]
    return Table(
        "free",
        (of, f"clear, seen {SEEN_M:g} m", "seen through", "healthy", "in a row", "too late"),
        rows,
        f"In the columns are: frames that call {SEEN_M:g} m of the path seen, of those with nothing on it "
        f"for {CLEAR_M:g} m; frames that call it seen {THROUGH_M:g} m beyond what is met, without a warning, "
        f"of those that meet something within {ASKED_M:g} m; how many of them call themselves healthy, and "
        f"the most in a row; frames in which nothing is warned of nor unknown up to what is met, and braking "
        f"by {BRAKING_M_S2:g} m/s2 would come too late.",
        "How far the path is free",
    )
