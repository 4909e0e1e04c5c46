"""Affinity and flow against equations 3 to 5 written in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from stage_library import Stages, camera, ffi, lib, parameters

FORMS = {"product": lib.VISTA_AFFINITY_FORM_PRODUCT, "sum": lib.VISTA_AFFINITY_FORM_SUM}
ALPHA, MU_INTENSITY, MU_SLOPE, FLOW_SCALE, FLOW_CONSTANT = 0.5, 2.0, 0.1, 10000.0, 10000.0  # of affinity.c
ENCODINGS = {
    "exponential": lib.VISTA_AFFINITY_FLOW_ENCODING_EXPONENTIAL,
    "linear": lib.VISTA_AFFINITY_FLOW_ENCODING_LINEAR,
}


def random_changes(random: np.random.Generator, form: str, encoding: str) -> dict[str, float]:
    return {
        "affinity.form": FORMS[form],
        "affinity.flow_encoding": ENCODINGS[encoding],
        "affinity.sigma_intensity": random.uniform(1, 60),
        "affinity.mu_disparity_px": random.uniform(0, 2),
        "affinity.mu_depth_m": random.uniform(0, 3),
        "affinity.sigma_disparity_px": random.uniform(0.2, 10),
    }


def random_cells(random: np.random.Generator, stages: Stages) -> None:
    """Grey and disparity that differ by little or much, a third of the cells without disparity."""
    count = stages.foveation.node_count
    stages.intensity[:] = random.choice([100.0, 200.0], count) + random.normal(0, 10, count)
    stages.disparity_px[:] = random.choice([3.0, 5.0, 40.0], count) + random.uniform(-2, 2, count)
    stages.disparity_px[random.random(count) < 0.3] = -1.0


def depth_step_px(stages: Stages, nearer_px: np.ndarray, step_m: float) -> np.ndarray:
    """The fall of the disparity over step_m of depth, at most 6 % of the range."""
    scale = stages.camera.focal_px * stages.camera.baseline_m
    depth_m = scale / nearer_px
    return nearer_px - scale / (depth_m + np.minimum(step_m, 0.06 * depth_m))


def term(difference: np.ndarray, mu: float | np.ndarray, sigma: float) -> np.ndarray:
    return np.exp(-((np.maximum(np.abs(difference), mu) - mu) ** 2) / (2 * sigma**2))


def intensity_term(stages: Stages) -> np.ndarray:
    p, grey = stages.parameters.affinity, stages.intensity.astype(float)
    return term(grey[stages.foveation.tail] - grey[stages.foveation.head], MU_INTENSITY, p.sigma_intensity)


def expected_weight(stages: Stages) -> np.ndarray:
    p, f = stages.parameters.affinity, stages.foveation
    i, j = f.tail, f.head
    d = stages.disparity_px.astype(float)
    d_intensity = intensity_term(stages)
    known = (d[i] >= 0) & (d[j] >= 0)
    relief = depth_step_px(stages, np.where(known, np.maximum(d[i], d[j]), 1.0), p.mu_depth_m)
    mu = np.maximum(relief, p.mu_disparity_px + MU_SLOPE * f.arc_distance_px)
    d_disparity = term(d[i] - d[j], mu, p.sigma_disparity_px)
    if p.form == FORMS["sum"]:
        both = ALPHA * d_intensity + (1 - ALPHA) * d_disparity
    else:
        both = d_intensity * d_disparity
    return np.where(known, both, d_intensity)


def expected_flow(stages: Stages, weight: np.ndarray) -> np.ndarray:
    p = stages.parameters.affinity
    if p.flow_encoding == ENCODINGS["linear"]:
        return FLOW_SCALE * (weight + 1) / 2
    return FLOW_SCALE * FLOW_CONSTANT ** ((weight - 1) / 2)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("form", FORMS)
def test_weights_and_capacities_are_those_of_the_equations(form: str, encoding: str) -> None:
    random = seeded(1)
    for _ in range(20):
        stages = Stages(camera(64, 48), random_changes(random, form, encoding))
        random_cells(random, stages)
        stages.compare()
        assert np.allclose(stages.weight, expected_weight(stages), rtol=2e-4, atol=1e-5)
        reverse = stages.foveation.reverse
        assert np.array_equal(stages.weight, stages.weight[reverse])
        assert np.array_equal(stages.capacity, stages.capacity[reverse])
        section = stages.section("affinity")
        assert stages.capacity.tolist() == [lib.vista_flow_encode(section, w) for w in stages.weight.tolist()]
        flow = expected_flow(stages, stages.weight.astype(float))
        assert np.abs(stages.capacity - flow).max() <= 0.5 + 1e-6
        without_disparity = np.maximum(expected_flow(stages, intensity_term(stages)), 1)
        assert np.allclose(stages.intensity_capacity, without_disparity, rtol=1e-3, atol=0.6)
        assert stages.weight.min() >= 0 and stages.weight.max() <= 1
        assert stages.capacity.min() >= 1


def one_edge(stages: Stages, grey, disparity) -> float:
    """The weight between two neighbours with these values."""
    a, b = stages.foveation.tail[-1], stages.foveation.head[-1]
    stages.intensity[:], stages.disparity_px[:] = 0, -1
    stages.intensity[[a, b]], stages.disparity_px[[a, b]] = grey, disparity
    stages.compare()
    return float(stages.weight[-1])


def test_affinities_worked_by_hand() -> None:
    """One sigma beyond mu makes exp(-1/2); what lies within mu makes 1."""
    distance_px = float(Stages(camera(64, 48)).foveation.arc_distance_px[-1])
    plain = {
        "affinity.sigma_intensity": 10.0,
        "affinity.mu_disparity_px": 0.5 - MU_SLOPE * distance_px,
        "affinity.mu_depth_m": 0.0,
        "affinity.sigma_disparity_px": 1.0,
    }
    product = Stages(camera(64, 48), plain | {"affinity.form": FORMS["product"]})
    added = Stages(camera(64, 48), plain | {"affinity.form": FORMS["sum"]})
    one_sigma = np.exp(-0.5)
    for stages in (product, added):
        assert one_edge(stages, (50, 52), (10, 10.5)) == pytest.approx(1.0)
        assert one_edge(stages, (50, 62), (10, -1)) == pytest.approx(one_sigma)
        assert one_edge(stages, (62, 50), (-1, -1)) == pytest.approx(one_sigma)
        assert one_edge(stages, (50, 50), (0, -1)) == pytest.approx(1.0)
    assert one_edge(product, (50, 62), (10, 11.5)) == pytest.approx(one_sigma**2)
    assert one_edge(added, (50, 62), (10, 10)) == pytest.approx(ALPHA * one_sigma + 1 - ALPHA)
    assert one_edge(added, (50, 50), (10, 11.5)) == pytest.approx(ALPHA + (1 - ALPHA) * one_sigma)


def test_relief_of_near_things_is_no_difference() -> None:
    """f B = 200 px m: 20 px is 10 m away, 19.05 px half a metre more; at 2 m the limit is 12 cm, 6 %."""
    stages = Stages(
        camera(64, 48),
        {"affinity.mu_disparity_px": 0.1, "affinity.mu_depth_m": 0.5},
    )
    assert one_edge(stages, (9, 9), (20, 200 / 10.5 + 0.01)) == pytest.approx(1.0)
    assert one_edge(stages, (9, 9), (20, 200 / 10.5 - 0.2)) < 0.999
    assert one_edge(stages, (9, 9), (100, 200 / 2.12 + 0.01)) == pytest.approx(1.0)
    assert one_edge(stages, (9, 9), (100, 200 / 2.12 - 0.2)) < 0.999


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_flow_spans_what_the_encoding_says(encoding: str) -> None:
    values = parameters(
        {
            "affinity.flow_encoding": ENCODINGS[encoding],
        }
    )
    section = ffi.addressof(values, "affinity")
    flow = [lib.vista_flow_encode(section, w) for w in np.linspace(0, 1, 101)]
    assert flow[-1] == 10000
    assert flow[0] == {"linear": 5000, "exponential": 100}[encoding]
    assert np.all(np.diff(flow) > 0)
