"""Single things of sampled worlds: what they are made of, and where it is."""

from __future__ import annotations

from vista_eval.worlds.sampled.grounds import COUNTRY_AND_TOWN

FLIGHTS = 2000


def test_no_cover_is_drawn_twice_as_often_as_others() -> None:
    assert len(set(COUNTRY_AND_TOWN)) == len(COUNTRY_AND_TOWN)
