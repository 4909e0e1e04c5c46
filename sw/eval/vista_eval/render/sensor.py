"""The image sensor: exposure, shot and read noise, gain mismatch between the cameras, 8 bits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np


@dataclass(frozen=True)
class Sensor:
    full_well_e: float = 12000.0  # electrons at grey level 255
    read_noise_e: float = 20.0
    gain: tuple[float, float] = (1.0, 1.03)  # left, right: automatic gain never agrees quite
    exposure: float = 1.0  # radiance to a fraction of the full well

    def with_noise(self, grey_levels: float) -> Self:
        """The sensor with noise of that standard deviation in the dark; what is bright has shot noise
        besides."""
        return replace(self, read_noise_e=grey_levels * self.full_well_e / 255)


def expose(sensor: Sensor, radiance: np.ndarray, camera: int, seed: tuple[int, ...]) -> np.ndarray:
    """Radiance (H, W) -> grey levels (H, W) uint8; the same seed gives the same bytes."""
    rng = np.random.default_rng(seed)
    mean_e = np.clip(radiance * sensor.exposure, 0, None) * sensor.full_well_e
    noise_e = rng.standard_normal(mean_e.shape) * np.sqrt(mean_e + sensor.read_noise_e**2)
    grey = (mean_e + noise_e) * (255 / sensor.full_well_e) * sensor.gain[camera]
    return np.clip(np.rint(grey), 0, 255).astype(np.uint8)
