"""Stills of rooms by a camera with a baseline of 7.5 cm: what fills the view at two metres is an obstacle."""

from __future__ import annotations

import numpy as np
import pytest
from shared_data import REPOSITORY
from vista import parameters
from vista.chain import fitted_to, make_chain, run_frame
from vista.sequence import open_sequence

OAK_D = REPOSITORY / "build" / "demo" / "oak-d"
ARMCHAIR = "bedroom_chair"
ARMCHAIR_MIDDLE = (0.39, 0.62)  # of width and height

pytestmark = pytest.mark.skipif(not OAK_D.is_dir(), reason=f"{OAK_D} is not there: make demo-pairs")


def test_something_is_an_obstacle_in_every_room_and_the_armchair_is_one() -> None:
    sequence = open_sequence(OAK_D)
    chain = make_chain(sequence, "golden", fitted_to(sequence, parameters.defaults()), threads=1)
    found = {}
    for files in sequence.frames:
        result = run_frame(chain, files).result
        accepted = np.array([verdict == "ACCEPTED" for verdict in result.verdict_of_region] + [False])
        found[files.left.name.removesuffix("_left.png")] = accepted[result.region_of_pixel]
    assert all(mask.mean() > 0.05 for mask in found.values())
    height, width = found[ARMCHAIR].shape
    u, v = (round(share * side) for share, side in zip(ARMCHAIR_MIDDLE, (width, height), strict=True))
    assert found[ARMCHAIR][v - 20 : v + 21, u - 20 : u + 21].mean() > 0.9
