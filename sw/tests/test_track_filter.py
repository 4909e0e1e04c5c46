"""The filter of one track against one in numpy, its covariance against the errors it makes (NEES)."""

from __future__ import annotations

import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from scipy.special import chdtri
from track_library import (
    BASELINE,
    CENTER,
    FOCAL,
    SIGMAS,
    Tracker,
    detection,
    jacobian,
    measure,
    seen_at,
    state,
)

ACCELERATION_PSD_M2_S3, POSITION_PSD_M2_S = 0.01, 0.01  # of track_filter.c

# Association out of the way: one object, always in the gate, never blamed.
OPEN = {
    "gate_chi2": 1000.0,
    "disparity_max_px": 1e5,
    "margin_left_px": 0.0,
    "margin_px": 0.0,
    "range_max_m": 1e5,
}


class ReferenceFilter:
    """Extended Kalman filter as in the textbook: nearly constant velocity, (u, v, d) through the pose."""

    def __init__(self, settings, measurement: np.ndarray, position: np.ndarray, rotation: np.ndarray) -> None:
        self.settings = settings
        u, v, d = measurement
        camera = np.array([(u - CENTER[0]) / d, (v - CENTER[1]) / d, FOCAL / d]) * BASELINE
        turn = np.radians(settings.attitude_sigma_deg)
        j = jacobian(*measurement)
        spread = j @ np.diag(np.square(SIGMAS)) @ j.T + (camera[2] * turn) ** 2 * np.diag([1, 1, 0])
        self.x = np.concatenate([rotation @ camera + position, np.zeros(3)])
        self.P = np.zeros((6, 6))
        self.P[:3, :3] = rotation @ spread @ rotation.T
        self.P[3:, 3:] = np.eye(3) * settings.velocity_sigma_m_s**2

    def predict(self, dt: float) -> None:
        F = np.kron([[1, dt], [0, 1]], np.eye(3))
        q, w = ACCELERATION_PSD_M2_S3, POSITION_PSD_M2_S
        self.x = F @ self.x
        self.P = F @ self.P @ F.T + np.kron(
            [[q * dt**3 / 3 + w * dt, q * dt**2 / 2], [q * dt**2 / 2, q * dt]], np.eye(3)
        )

    def update(self, measurement: np.ndarray, position: np.ndarray, rotation: np.ndarray) -> None:
        x, y, z = rotation.T @ (self.x[:3] - position)
        J = np.array(
            [
                [FOCAL / z, 0, -FOCAL * x / z**2],
                [0, FOCAL / z, -FOCAL * y / z**2],
                [0, 0, -FOCAL * BASELINE / z**2],
            ]
        )
        H = np.hstack([J @ rotation.T, np.zeros((3, 3))])
        turn = FOCAL * np.radians(self.settings.attitude_sigma_deg)
        R = np.diag(np.square(SIGMAS)) + turn**2 * np.diag([1, 1, 0])
        S = H @ self.P @ H.T + R
        K = self.P @ H.T @ np.linalg.inv(S)
        self.x = self.x + K @ (measurement - measure(self.x[:3], position, rotation))
        self.P = (np.eye(6) - K @ H) @ self.P  # the short form: equal in exact arithmetic


@pytest.mark.slow
def test_the_filter_is_the_textbook_one() -> None:
    random = seeded(1)
    for _ in range(20):
        tracker = Tracker(**OPEN)
        truth = np.array([*random.uniform(-4, 4, 2), 60.0])
        reference, t = None, 0.0
        for _ in range(40):
            position = np.array([*random.normal(0, 0.3, 2), 8.0 * t])
            rotation = Rotation.from_euler("xyz", random.normal(0, 2, 3), degrees=True).as_matrix()
            seen = measure(truth, position, rotation) + random.normal(size=3) * SIGMAS
            assert tracker.update(t, [detection(seen)], position, rotation) == "VISTA_OK"
            if reference is None:
                reference = ReferenceFilter(tracker.params, seen, position, rotation)
            else:
                reference.update(seen, position, rotation)
            mean, covariance = state(tracker.tracks[1])
            assert mean == pytest.approx(reference.x, rel=1e-8, abs=1e-8)
            assert covariance == pytest.approx(reference.P, rel=1e-6, abs=1e-9)
            assert (covariance == covariance.T).all()
            assert np.linalg.eigvalsh(covariance).min() > 0
            dt = random.uniform(0.02, 0.15)
            t = round(t + dt, 9)
            reference.predict(round(dt, 9))


@pytest.mark.slow
@pytest.mark.parametrize("range_m", [18.0, 35.0, 60.0, 85.0])
def test_the_covariance_is_that_of_the_errors(range_m: float) -> None:
    """Normalised estimation error squared; truths from the model itself, seen from a moving aircraft."""
    random, runs, dt = seeded(2), 300, 0.1
    nees, nees_position = [], []
    for _ in range(runs):
        tracker = Tracker(4, 4, attitude_sigma_deg=0.0, **OPEN)
        settings = tracker.params
        truth = np.array([*(random.uniform(-0.15, 0.15, 2) * range_m), range_m])
        velocity = random.normal(0, settings.velocity_sigma_m_s, 3)
        for frame in range(12):
            position = np.array([0.0, 0.0, 0.9 * frame])
            seen = measure(truth, position) + random.normal(size=3) * SIGMAS
            assert tracker.update(frame * dt, [detection(seen)], position) == "VISTA_OK"
            actual = np.concatenate([truth, velocity])
            q, w = ACCELERATION_PSD_M2_S3, POSITION_PSD_M2_S
            noise = np.linalg.cholesky([[q * dt**3 / 3 + w * dt, q * dt**2 / 2], [q * dt**2 / 2, q * dt]])
            step = noise @ random.normal(size=(2, 3))
            truth, velocity = truth + dt * velocity + step[0], velocity + step[1]
        mean, covariance = state(tracker.tracks[1])
        error = mean - actual
        nees.append(error @ np.linalg.solve(covariance, error))
        nees_position.append(error[:3] @ np.linalg.solve(covariance[:3, :3], error[:3]))
    for values, freedom in ((nees, 6), (nees_position, 3)):
        low, high = chdtri(freedom * runs, [1 - 5e-5, 5e-5]) / runs
        assert low < np.mean(values) < high, f"{freedom} dof at {range_m} m: {np.mean(values):.2f}"


def test_a_far_obstacle_is_uncertain_along_its_ray_only() -> None:
    tracker = Tracker()
    direction = np.array([0.1, -0.05, 1.0])
    tracker.update(0.0, [seen_at(80 * direction)])
    covariance = state(tracker.tracks[1])[1][:3, :3]
    values, vectors = np.linalg.eigh(covariance)
    assert values[2] > 100 * values[1]
    assert abs(vectors[:, 2] @ direction) / np.linalg.norm(direction) > 0.9999


def test_a_fast_approach_keeps_a_static_obstacle_static() -> None:
    tracker, point = Tracker(), np.array([1.0, -0.5, 90.0])
    random = seeded(3)
    for frame in range(80):
        position = np.array([0.0, 0.0, 0.91 * frame])
        seen = measure(point, position) + random.normal(size=3) * SIGMAS
        tracker.update(0.1 * frame, [detection(seen)], position)
    (id_,) = tracker.confirmed  # 1, unless its second detection was the one in a hundred outside the gate
    mean, covariance = state(tracker.tracks[id_])
    sigma = np.sqrt(np.diag(covariance))
    assert (np.abs(mean[:3] - point) < 5 * sigma[:3]).all()
    assert (np.abs(mean[3:]) < 5 * sigma[3:]).all()
    assert np.linalg.norm(mean[:3] - point) < 0.5


def test_extents_average_and_one_wrong_region_does_not_resize_a_track() -> None:
    tracker, point = Tracker(), (0.0, 0.0, 40.0)
    random = seeded(4)
    for frame in range(40):
        extent = np.array([2.0, 1.0]) * np.exp(random.normal(0, 0.1, 2))
        tracker.update(0.1 * frame, [seen_at(point, extent=extent.tolist())])
    before = list(tracker.tracks[1].extent_m)
    assert before == pytest.approx([2.0, 1.0], rel=0.25)
    tracker.update(4.0, [seen_at(point, extent=(40.0, 0.02))])
    after = list(tracker.tracks[1].extent_m)
    assert before[0] < after[0] < 1.6 * before[0]
    assert before[1] > after[1] > before[1] / 1.6
    tracker.update(4.1, [seen_at(point, extent=(0.5, 0.5), cut=(True, True))])
    assert list(tracker.tracks[1].extent_m) == after  # cut by the border: a lower bound that is met
