"""Images of a noisier sensor: normal noise on every pixel, independent between pixels and cameras."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from vista.sequence import Frame, FrameFiles, Sequence


@dataclass(frozen=True)
class NoisySequence(Sequence):
    """A sequence whose images have noise added as they are read; the same seed gives the same images."""

    sigma_grey: float = 0.0
    seed: int = 1

    def read(self, files: FrameFiles) -> Frame:
        exact = super().read(files)
        left, right = (
            noisy_image(image, self.sigma_grey, (self.seed, files.index, camera))
            for camera, image in enumerate((exact.left, exact.right))
        )
        return Frame(exact.index, exact.t_ns, left, right, exact.world_from_camera)


def with_noise(sequence: Sequence, sigma_grey: float, seed: int) -> Sequence:
    """sigma_grey: standard deviation of the noise in grey levels; 0 leaves the sequence as it is."""
    if sigma_grey == 0.0:
        return sequence
    content = {field.name: getattr(sequence, field.name) for field in fields(Sequence)}
    return NoisySequence(**content, sigma_grey=sigma_grey, seed=seed)


def noisy_image(image: NDArray[np.uint8], sigma_grey: float, seed: tuple[int, ...]) -> NDArray[np.uint8]:
    """Clipped to 0 .. 255, as a sensor clips."""
    noise = np.random.default_rng(seed).standard_normal(image.shape, np.float32)
    return np.clip(np.rint(image + np.float32(sigma_grey) * noise), 0, 255).astype(np.uint8)
