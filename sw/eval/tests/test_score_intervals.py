"""Intervals over flights: exact ones against scipy's, bootstrapped ones against how often they hold the
truth."""

from __future__ import annotations

import pytest
from random_seed import seeded
from scipy.special import betaincinv, chdtri
from vista_eval.metrics.intervals import clopper_pearson, poisson, share_of_flights, share_of_frames
from vista_eval.suites.world_tables import share_text


@pytest.mark.parametrize("whole", [1, 7, 40])
def test_clopper_and_pearson(whole: int) -> None:
    """The quantiles of the beta distribution give them."""
    for part in range(whole + 1):
        low, high = clopper_pearson(part, whole)
        assert low == pytest.approx(betaincinv(part, whole - part + 1, 0.025) if part else 0.0, abs=1e-9)
        assert high == pytest.approx(
            betaincinv(part + 1, whole - part, 0.975) if part < whole else 1.0, abs=1e-9
        )


@pytest.mark.parametrize("count", [0, 1, 7, 400])
def test_counts_of_events(count: int) -> None:
    """The quantiles of chi-square give them."""
    low = chdtri(2 * count, 0.975) / 2 if count else 0.0
    assert poisson(count) == pytest.approx((low, chdtri(2 * count + 2, 0.025) / 2), abs=1e-6)


def test_many_flights() -> None:
    """The coefficients of 1,300 flights are larger than any float."""
    for part in (1, 13, 650, 1299):
        expected = (betaincinv(part, 1301 - part, 0.025), betaincinv(part + 1, 1300 - part, 0.975))
        assert clopper_pearson(part, 1300) == pytest.approx(expected, abs=1e-9)


def test_all_or_nothing_is_a_count_of_flights() -> None:
    """20 of 20 frames in each of 7 flights: 7 of 7, not 140 of 140."""
    everything, nothing = share_of_frames([(20, 20)] * 7), share_of_frames([(0, 20)] * 7)
    assert everything is not None and nothing is not None
    assert (everything.part, everything.whole, everything.exact) == (140, 140, True)
    assert (everything.low, everything.high) == clopper_pearson(7, 7)
    assert (nothing.low, nothing.high) == clopper_pearson(0, 7)
    assert share_of_frames([(0, 0)]) is None
    assert share_of_flights([]) is None


def test_a_count_of_flights() -> None:
    share = share_of_flights([True, False, False, False])
    assert share is not None
    assert (share.part, share.whole, share.exact) == (1, 4, True)
    assert (share.low, share.high) == clopper_pearson(1, 4)


@pytest.mark.parametrize("flights", [1, 2])
def test_few_flights_have_no_bootstrap(flights: int) -> None:
    """But the exact interval for the count of flights."""
    share = share_of_frames([(18, 20)] * flights)
    assert share is not None
    assert (share.low, share.high, share.exact) == (None, None, False)
    assert share_text(share) == f"{18 * flights}/{20 * flights}"
    assert share_text(share_of_frames([(18, 20)] * 3)) == "54/60 (90 to 90 %)"
    counted = share_of_flights([True] * flights)
    assert counted is not None
    assert (counted.low, counted.high) == clopper_pearson(flights, flights)
    assert share_text(counted).endswith("%*)")


def test_the_bootstrap_draws_flights_not_frames() -> None:
    """Half the flights have all frames, half none: the interval is far wider than that of as many single
    frames."""
    share = share_of_frames([(50, 50), (0, 50)] * 10)
    assert share is not None and not share.exact
    assert share.low is not None and share.high is not None
    assert share.value == 0.5
    assert 0.15 < share.low < 0.35 and 0.65 < share.high < 0.85


def test_the_bootstrap_holds_the_truth() -> None:
    """Flights whose own share is drawn anew each time: the interval holds the mean in 95 %, and in 84 % at
    the least for 20 flights."""
    random = seeded(1)
    held = 0
    for trial in range(150):
        shares = random.beta(4.0, 1.0, 20)
        counts = [(int(random.binomial(25, share)), 25) for share in shares]
        found = share_of_frames(counts, seed=trial)
        assert found is not None and found.low is not None and found.high is not None
        held += found.low <= 0.8 <= found.high
    assert held >= 0.84 * 150
