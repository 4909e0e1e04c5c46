"""What happens to the light of a scene in a lens that is not perfect, while the camera moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from vista_eval.render.rig import Rig
from vista_eval.render.sensor import Sensor

FAR_M = 1e6  # of the sky
BLUR_STEP_PX = 0.7  # between the images that a moving one is the mean of
VEIL_DEG = 6.0  # from the sun at which its veil has fallen to half
VEIL_REACHES_DEG = 60.0  # beyond, the lens is in its own shade
GHOSTS = ((-0.35, 26.0, 0.12), (-0.8, 46.0, 0.07), (0.45, 18.0, 0.10))  # place, radius in px, share of glare
SPECK_PX = (6.0, 28.0)  # radius of dirt, which is far out of focus
DIRT_GLOW = 0.35  # what dirt scatters of the light all around


@dataclass(frozen=True)
class FlawedSensor(Sensor):
    """A sensor behind a lens, each with its faults. A flight's faults stay the same in all of its frames."""

    defocus_px: tuple[float, float] = (0.0, 0.0)  # left, right: radius of the disc that a point becomes
    exposure_s: float = 0.0  # while the camera moves
    vignetting: float = 0.0  # share of the light that the corners lack
    glare: float = 0.0  # radiance of the veil where the sun is, or would be
    dirt: tuple[float, float] = (0.0, 0.0)  # left, right: share of the image that specks cover


@dataclass(frozen=True)
class Exposure:
    """How one camera looks at the scene, and how it moves."""

    rig: Rig
    camera: int
    opens: np.ndarray  # world_from_camera, 4x4
    middle: np.ndarray
    closes: np.ndarray
    depth_m: np.ndarray  # (H, W), inf = sky
    to_sun: tuple[float, float, float]
    seed: int  # of the flight


def through_lens(lens: FlawedSensor, radiance: np.ndarray, exposure: Exposure) -> np.ndarray:
    """(H, W) what reaches the sensor, as radiance."""
    seen: np.ndarray = radiance.astype(np.float32)
    if lens.exposure_s > 0:
        seen = smeared(seen, image_motion_px(exposure))
    if lens.defocus_px[exposure.camera] > 0:
        seen = defocused(seen, lens.defocus_px[exposure.camera])
    if lens.glare > 0:
        seen = seen + lens.glare * veil(exposure)
    if lens.dirt[exposure.camera] > 0:
        opacity = dirt(seen.shape, lens.dirt[exposure.camera], (exposure.seed, exposure.camera))
        seen = seen * (1 - opacity) + DIRT_GLOW * float(seen.mean()) * opacity
    if lens.vignetting > 0:
        seen = seen * (1 - lens.vignetting * corner_distance(exposure.rig) ** 2)
    return seen.astype(np.float32)


def pixel_rays(rig: Rig) -> np.ndarray:
    """(H, W, 3) of length 1 along the optical axis, camera."""
    (cu, cv), focal = rig.center_px, rig.focal_px
    v, u = np.mgrid[0 : rig.height_px, 0 : rig.width_px]
    return np.stack([(u - cu) / focal, (v - cv) / focal, np.ones(u.shape)], axis=-1)


def image_motion_px(exposure: Exposure) -> np.ndarray:
    """(H, W, 2) where what a pixel shows is seen when the shutter closes, against when it opens. What moves
    by itself counts as standing."""
    depth_m = np.where(np.isinf(exposure.depth_m), FAR_M, exposure.depth_m)
    points = pixel_rays(exposure.rig) * depth_m[..., None]
    ends = []
    for pose in (exposure.opens, exposure.closes):
        relative = np.linalg.inv(pose) @ exposure.middle
        ends.append(exposure.rig.project(points @ relative[:3, :3].T + relative[:3, 3]))
    return ends[1] - ends[0]


def smeared(image: np.ndarray, motion_px: np.ndarray) -> np.ndarray:
    """The mean over the motion, whose middle is where the image is."""
    longest_px = float(np.quantile(np.hypot(motion_px[..., 0], motion_px[..., 1]), 0.99))
    count = int(np.clip(np.ceil(longest_px / BLUR_STEP_PX), 1, 40))
    v, u = np.mgrid[0 : image.shape[0], 0 : image.shape[1]].astype(np.float32)
    total = np.zeros_like(image)
    for share in (np.arange(count) + 0.5) / count - 0.5:
        du, dv = (np.float32(share) * motion_px[..., k].astype(np.float32) for k in range(2))
        total += cv2.remap(image, u + du, v + dv, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return total / np.float32(count)


def defocused(image: np.ndarray, radius_px: float) -> np.ndarray:
    return cv2.filter2D(image, -1, disc(radius_px), borderType=cv2.BORDER_REPLICATE)


def disc(radius_px: float) -> np.ndarray:
    """Share of each pixel that a disc covers, of sum 1."""
    fine, reach = 9, int(np.ceil(radius_px + 0.5))
    line = (np.arange((2 * reach + 1) * fine) + 0.5) / fine - reach - 0.5
    inside = (np.hypot(line[:, None], line[None, :]) <= radius_px).astype(np.float32)
    cells = inside.reshape(2 * reach + 1, fine, 2 * reach + 1, fine).mean(axis=(1, 3))
    return np.asarray(cells / cells.sum(), np.float32)


def veil(exposure: Exposure) -> np.ndarray:
    """(H, W) light that the sun scatters in the lens: 1 towards the sun, with images of the aperture. Both
    cameras have it at the same place, as if it were infinitely far."""
    sun = exposure.middle[:3, :3].T @ (np.array(exposure.to_sun) / np.linalg.norm(exposure.to_sun))
    rays = pixel_rays(exposure.rig)
    cosine = np.clip(rays @ sun / np.linalg.norm(rays, axis=-1), -1, 1)
    angle_deg = np.degrees(np.arccos(cosine))
    axis_deg = float(np.degrees(np.arccos(np.clip(sun[2], -1, 1))))
    strength = np.clip(1.5 - axis_deg / VEIL_REACHES_DEG, 0, 1) if axis_deg < 1.5 * VEIL_REACHES_DEG else 0.0
    found = strength / (1 + (angle_deg / VEIL_DEG) ** 2)
    if sun[2] > 0.5:
        found += strength * ghosts(exposure.rig, sun)
    return np.asarray(found, np.float32)


def ghosts(rig: Rig, sun: np.ndarray) -> np.ndarray:
    """Draws ghosts on the line from the sun's image through the middle of the picture."""
    v, u = np.mgrid[0 : rig.height_px, 0 : rig.width_px]
    center = np.array(rig.center_px)
    to_sun = rig.project(sun) - center
    found = np.zeros(u.shape)
    for place, radius_px, share in GHOSTS:
        at = center + place * to_sun
        edge = radius_px - np.hypot(u - at[0], v - at[1])
        found += share * np.clip(edge / 3, 0, 1)
    return found


@lru_cache(maxsize=4)
def dirt(shape: tuple[int, ...], share: float, seed: tuple[int, int]) -> np.ndarray:
    """(H, W) opacity in 0..1 of specks that cover about a share of the image."""
    random = np.random.default_rng((*seed, 9))
    v, u = (index.astype(np.float32) for index in np.indices(shape))
    clear = np.ones(shape, np.float32)
    while 1 - float((clear > 0.9).mean()) < share:
        radius = random.uniform(*SPECK_PX)
        at = random.uniform(0, shape[1]), random.uniform(0, shape[0])
        stretch, turn = random.uniform(0.6, 1.0), random.uniform(0, np.pi)
        x = (u - at[0]) * np.cos(turn) + (v - at[1]) * np.sin(turn)
        y = (v - at[1]) * np.cos(turn) - (u - at[0]) * np.sin(turn)
        inside = np.clip(1.4 - 1.2 * np.hypot(x, y / stretch) / radius, 0, 1)
        clear *= 1 - random.uniform(0.35, 0.95) * inside.astype(np.float32)
    return 1 - clear


def corner_distance(rig: Rig) -> np.ndarray:
    """(H, W) from the middle, 1 in the corners."""
    v, u = np.mgrid[0 : rig.height_px, 0 : rig.width_px]
    (cu, cv) = rig.center_px
    return np.asarray(np.hypot(u - cu, v - cv) / np.hypot(cu, cv), np.float32)
