"""The learned odds, what they are worth on families held back, and the header of C that has them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from vista.geometry import Array

from vista_eval.cache import content_sha256
from vista_eval.metrics.rules import HIT_RANGE_M
from vista_eval.training.evidence import EMPTY, OCCUPIED, PIECES, FlightEvidence
from vista_eval.training.logistic import cross_validate, fit, losses, same_for_each

HEADER = "sw/src/space/space_odds.h"
WARN = 0.8  # the probability from which on a place is warned of: chosen on development flights
# Two cameras side by side do not see the range of what runs along their rows, nor of wires that lean.
TOLD_ONLY = ("steep_wire", "wires, by others")
BINS = 10  # of the reliability
ROUNDED = 2  # digits of a weight


@dataclass(frozen=True)
class Bin:
    """Places of all families held back that are given a probability between two tenths."""

    places: int
    given: float  # mean, each family weighing the same
    occupied: float  # share


@dataclass(frozen=True)
class FamilyHeld:
    """Frames of one family, judged by odds that it had no part in."""

    name: str
    fitted: bool  # the odds of the other families are fitted on it
    places: int
    log_loss: float
    asked: int  # frames with a place that is occupied in the range of hits
    hits: int  # of these, with the first warning within twice the reach of such a place
    frames: int
    false_contacts: int  # frames whose first warning is at a place that is empty


@dataclass(frozen=True)
class Odds:
    weights: dict[str, float]  # PRIOR, then PIECES
    gain: dict[str, float]  # of each piece: log loss of families held back without it, less that with it
    before: float  # log loss of the probabilities that the detector gives now
    families: list[FamilyHeld]
    bins: list[Bin]
    flights: int  # that are learned from
    digest: str  # of what is learned from

    @property
    def useless(self) -> list[str]:
        """Pieces that gain nothing on families held back."""
        return [name for name, gain in self.gain.items() if gain <= 0.0]

    @property
    def log_loss(self) -> float:
        return mean_of_fitted({family.name: family.log_loss for family in self.families})


def mean_of_fitted(loss: dict[str, float]) -> float:
    return float(np.mean([value for name, value in loss.items() if name not in TOLD_ONLY]))


def learn(flights: list[FlightEvidence]) -> Odds:
    x, y = np.concatenate([one.pieces for one in flights]), np.concatenate([one.truth for one in flights])
    group = np.concatenate([np.full(len(one.truth), one.family) for one in flights])
    held = cross_validate(x, y, group, TOLD_ONLY)
    with_all = mean_of_fitted(held.loss)
    gain = {}
    for k, name in enumerate(PIECES):
        without = cross_validate(np.delete(x, k, axis=1), y, group, TOLD_ONLY)
        gain[name] = mean_of_fitted(without.loss) - with_all
    learnt = (y >= 0) & ~np.isin(group, TOLD_ONLY)
    weights = fit(x[learnt], y[learnt], same_for_each(group[learnt]))
    told = np.concatenate([one.told for one in flights])
    before = losses(told, y)[learnt] @ same_for_each(group[learnt]) / len(np.unique(group[learnt]))
    names = list(dict.fromkeys(one.family for one in flights))
    ends = np.cumsum([len(one.truth) for one in flights])[:-1]
    by_flight = np.split(held.probability, ends)
    members = {name: [k for k, one in enumerate(flights) if one.family == name] for name in names}
    return Odds(
        {name: round(float(value), ROUNDED) for name, value in zip(("PRIOR", *PIECES), weights, strict=True)},
        gain,
        float(before),
        [
            family_held(name, [(flights[k], by_flight[k]) for k in members[name]], held.loss[name])
            for name in names
            if name in held.loss
        ],
        reliability(held.probability[learnt], y[learnt], same_for_each(group[learnt])),
        sum(one.family not in TOLD_ONLY for one in flights),
        content_sha256(x[learnt], y[learnt], group[learnt].tolist()),
    )


def family_held(name: str, flights: list[tuple[FlightEvidence, Array]], loss: float) -> FamilyHeld:
    counts = np.sum([contacts(flight, given) for flight, given in flights], axis=0)
    return FamilyHeld(
        name,
        name not in TOLD_ONLY,
        sum(int((flight.truth >= 0).sum()) for flight, _ in flights),
        loss,
        *counts.tolist(),
    )


def contacts(flight: FlightEvidence, given: Array) -> tuple[int, int, int, int]:
    """Frames asked for a warning, of these hit, all frames, and those with a false contact."""
    asked = hits = false = 0
    near_m, far_m = HIT_RANGE_M
    frames = np.unique(flight.frame).tolist()
    for frame in frames:
        places = np.flatnonzero(flight.frame == frame)
        truth, along_m = flight.truth[places], flight.along_m[places]
        warned = np.flatnonzero((given[places] >= WARN) & flight.known[places])[:1]
        occupied_m = along_m[truth == OCCUPIED]
        if len(occupied_m) and near_m <= occupied_m[0] <= far_m:
            asked += 1
            off_m = np.abs(occupied_m[:, np.newaxis] - along_m[warned])
            hits += bool((off_m <= 2.0 * flight.reach_m[places][warned]).any())
        false += bool((truth[warned] == EMPTY).any())
    return asked, hits, len(frames), false


def reliability(given: Array, truth: NDArray[np.int64], weight: Array) -> list[Bin]:
    """A bin a tenth of probability."""
    which = np.minimum((BINS * given).astype(int), BINS - 1)
    found = []
    for k in range(BINS):
        w = weight * (which == k)
        whole = float(w.sum()) or np.nan
        found.append(Bin(int((which == k).sum()), float(w @ given) / whole, float(w @ truth) / whole))
    return found


def header(odds: Odds) -> str:
    """The text of HEADER."""
    families = sum(family.fitted for family in odds.families)
    lines = [
        f"/* Written by `vista train` from {odds.flights} flights of {families} families; do not edit.",
        f" * Digest of what was learned from: {odds.digest}",
        " *",
        " * Log-odds that a place on the flight path is occupied: what each piece of evidence adds "
        "(path_places.h). */",
        "#ifndef VISTA_SRC_SPACE_ODDS_H",
        "#define VISTA_SRC_SPACE_ODDS_H",
        "",
        f"#define VISTA_ODDS_WARN {WARN} /* the probability from which on a place is warned of */",
        *(f"#define VISTA_ODDS_{name} {in_c(value)}" for name, value in odds.weights.items()),
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def in_c(value: float) -> str:
    return f"({value:.{ROUNDED}f})" if value < 0.0 else f"{value:.{ROUNDED}f}"
