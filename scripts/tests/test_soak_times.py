"""The tables of a mix of recordings."""

from __future__ import annotations

import numpy as np
from soak_times import SHOWN, tables


def test_all_frames_count_and_each_recording_has_its_row() -> None:
    quick, slow = ({key: np.full(count, ms) for key in SHOWN} for count, ms in ((999, 10.0), (1, 40.0)))
    whole, single = tables({"street": [quick], "wires": [slow, slow]}, given=1010)
    assert whole.rows[0] == ("engine", "1001", "10.0", "10.0", "40.0", "40.0", "4.0")
    assert whole.rows[-1][:2] == ("frames that gave way to newer ones", "9")
    assert [row[:2] for row in single.rows] == [("street", "999"), ("wires", "2")]


def test_a_program_that_takes_other_times_is_told_apart() -> None:
    one = {key: np.linspace(1.0, 2.0, 101) * (key == "host") + 5.0 for key in SHOWN}
    rows = {row[0]: row for row in tables({"street": [one]}, given=101)[0].rows}
    assert rows["host"][2:] == ("6.5", "7.0", "7.0", "7.0", "1.1")
    assert rows["engine"][2:] == ("5.0", "5.0", "5.0", "5.0", "1.0")
