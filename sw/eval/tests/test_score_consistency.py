"""The NEES band: quantiles against scipy, coverage over simulated filters, what correlation does to it."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.special import chdtri
from vista_eval.metrics.consistency import DIMENSIONS, chi_square_quantile, consistency, effective_samples


@pytest.mark.parametrize(("degrees", "accuracy"), [(3.0, 0.17), (7.5, 0.03), (30.0, 0.004), (500.0, 1e-4)])
@pytest.mark.parametrize("probability", [0.025, 0.5, 0.975])
def test_quantiles_against_scipy(degrees: float, accuracy: float, probability: float) -> None:
    exact = chdtri(degrees, 1.0 - probability)
    assert chi_square_quantile(probability, degrees) == pytest.approx(exact, rel=accuracy)


def correlated_nees(
    random: np.random.Generator, frames: int, keep: float, dimensions: int = DIMENSIONS
) -> np.ndarray:
    """The NEES of errors that follow a first-order process of unit variance."""
    error = random.standard_normal(dimensions)
    series = []
    for _ in range(frames):
        series.append(error @ error)
        error = keep * error + np.sqrt(1.0 - keep**2) * random.standard_normal(dimensions)
    return np.array(series)


def test_the_band_holds_honest_covariances_and_not_others() -> None:
    """An error of half the size that the covariance says, or of twice, leaves the band."""
    random = seeded(1)
    runs = [[correlated_nees(random, 60, 0.5) for _ in range(8)] for _ in range(60)]
    inside = [consistency([(one, DIMENSIONS) for one in run]).within for run in runs]
    assert np.mean(inside) > 0.75
    for scale in (0.25, 4.0):
        wrong = [[(scale * series, DIMENSIONS) for series in run] for run in runs]
        assert not any(consistency(run).within for run in wrong)


def test_the_band_holds_positions_and_distances_together() -> None:
    """Half of the flights have errors of one dimension; taken for three, they leave the band."""
    random = seeded(3)
    runs = [
        [(correlated_nees(random, 60, 0.5, 1 + 2 * (k % 2)), 1 + 2 * (k % 2)) for k in range(8)]
        for _ in range(60)
    ]
    found = [consistency(run) for run in runs]
    assert np.mean([each.within for each in found]) > 0.75
    assert np.mean([each.average for each in found]) == pytest.approx(2.0, abs=0.15)
    for run in runs:
        distances = [one for one in run if one[1] == 1]
        as_positions = consistency([(values, DIMENSIONS) for values, _ in distances])
        assert not as_positions.within
        assert consistency(distances).high < as_positions.high


def test_correlation_leaves_fewer_samples() -> None:
    """NEES of errors correlated by a is correlated by a^2: N (1 - a^2) / (1 + a^2) samples."""
    random = seeded(2)
    for keep in (0.0, 0.5, 0.8):
        found = np.mean([effective_samples(correlated_nees(random, 2000, keep)) for _ in range(10)])
        assert found == pytest.approx(2000 * (1 - keep**2) / (1 + keep**2), rel=0.25)


def test_without_samples() -> None:
    assert consistency([]) is None
    assert consistency([(np.array([]), DIMENSIONS)]) is None
    assert effective_samples(np.array([2.0])) == 1.0
