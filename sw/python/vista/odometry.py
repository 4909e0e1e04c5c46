"""The motion of the camera from its own images, where nothing else tells it: odometry of OpenCV's parts.

Corners of a reference image with a disparity are points in space. They are followed into each later image by
optical flow, there and back, and the pose from which they are seen there is found by RANSAC. When few of the
points are left, the image becomes the next reference; errors add up only then. The result drifts: it has
no way to know a place again.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vista.geometry import Array, Calibration, Pose, camera_matrix
from vista.health.features import Grey, follow

CORNERS = 400
CORNER_QUALITY = 0.005  # of the best corner's response
CORNER_SPACING_PX = 9.0
BORDER_PX = 4
MIN_DISPARITY_PX = 2.0  # farther points say little about the way
WORD_SPREAD_PX = 1.0  # of the words around a corner: at an edge it may have either disparity
WORDS_PER_PX = 16.0
FLOW_LEVELS = 4
RANSAC_ERROR_PX = 1.5
RANSAC_ROUNDS = 300
MIN_INLIERS = 20  # six numbers are estimated; fewer points than this agree by chance
MIN_INLIER_SHARE = 0.4
KEEP_SHARE = 0.5  # of the reference's points; when fewer are left, a new reference is taken
LOST_FRAMES = 5  # without a pose, before the odometry begins anew


@dataclass(frozen=True)
class Reference:
    """An image whose pose is known, and points of it."""

    image: Grey
    pixels: NDArray[np.float32]  # (n, 2)
    points_m: Array  # (n, 3), in its camera
    world_from_camera: Pose


class StereoOdometry:
    """world_from_camera of one rectified left camera, frame by frame; the first one is the world."""

    def __init__(self, camera: Calibration) -> None:
        self._camera = camera
        self._matrix = camera_matrix(camera.focal_px, camera.focal_px, camera.cx, camera.cy)
        self._reference: Reference | None = None
        self._lost = 0
        self._begun = False
        self.restarts = 0  #: how often the world began anew, because the motion was lost for too long

    def reset(self) -> None:
        """What comes next does not continue what came before."""
        self._reference, self._lost, self._begun = None, 0, False

    def update(self, image: Grey, words: NDArray[np.int16]) -> Pose | None:
        """image, words: the rectified left image and its disparities in 1/16 px, negative where it has none.

        None: this image could not be placed. After LOST_FRAMES of them in a row the world begins anew, with
        the next image that can be a reference: what the poses before it told is of no use then."""
        if self._reference is None:
            return self._begin(image, words)
        found = self._locate(self._reference, image)
        if found is None:
            self._lost += 1
            if self._lost >= LOST_FRAMES:
                self._reference, self._lost = None, 0
            return None
        self._lost = 0
        pose, kept = found
        if kept < KEEP_SHARE:
            self._reference = self._make_reference(image, words, pose) or self._reference
        return pose

    def _begin(self, image: Grey, words: NDArray[np.int16]) -> Pose | None:
        self._reference = self._make_reference(image, words, Pose())
        if self._reference is None:
            return None
        self.restarts += self._begun
        self._begun = True
        return Pose()

    def _make_reference(self, image: Grey, words: NDArray[np.int16], pose: Pose) -> Reference | None:
        """None: too few corners with a disparity."""
        corners = cv2.goodFeaturesToTrack(image, CORNERS, CORNER_QUALITY, CORNER_SPACING_PX)
        if corners is None:
            return None
        pixels = np.asarray(corners, np.float32).reshape(-1, 2)
        disparities_px = _disparities_px(words, pixels)
        usable = disparities_px >= MIN_DISPARITY_PX
        if np.count_nonzero(usable) < MIN_INLIERS:
            return None
        pixels, disparities_px = pixels[usable], disparities_px[usable]
        depths_m = self._camera.focal_px * self._camera.baseline_m / disparities_px
        rays = (pixels - [self._camera.cx, self._camera.cy]) / self._camera.focal_px
        points_m = np.column_stack([rays * depths_m[:, None], depths_m])
        return Reference(image, pixels, points_m, pose)

    def _locate(self, reference: Reference, image: Grey) -> tuple[Pose, float] | None:
        """The pose of the image, and the share of the reference's points that tell it."""
        seen, followed = _follow(reference.image, image, reference.pixels)
        if np.count_nonzero(followed) < MIN_INLIERS:
            return None
        points_m, pixels = reference.points_m[followed], seen[followed]
        cv2.setRNGSeed(0)  # the same recording gives the same poses
        done, turn, way, inliers = cv2.solvePnPRansac(
            points_m,
            pixels.astype(np.float64),
            self._matrix,
            None,
            iterationsCount=RANSAC_ROUNDS,
            reprojectionError=RANSAC_ERROR_PX,
        )
        enough = max(MIN_INLIERS, MIN_INLIER_SHARE * len(pixels))
        if not done or inliers is None or len(inliers) < enough:
            return None
        agreeing = inliers.ravel()
        turn, way = cv2.solvePnPRefineLM(
            points_m[agreeing], pixels[agreeing].astype(np.float64), self._matrix, None, turn, way
        )
        rotation, translation_m = np.asarray(cv2.Rodrigues(turn)[0]), np.asarray(way).ravel()
        camera_from_reference = Pose(rotation.astype(np.float64), translation_m.astype(np.float64))
        pose = reference.world_from_camera @ camera_from_reference.inverse()
        return pose, len(agreeing) / len(reference.pixels)


def _follow(
    before: Grey, now: Grey, pixels: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Follows the pixels, and says of which that is sure, and ends within the image."""
    there, sure = follow(before, now, pixels, FLOW_LEVELS)
    height, width = now.shape
    inside = np.all((there >= BORDER_PX) & (there < [width - BORDER_PX, height - BORDER_PX]), axis=1)
    return there, sure & inside


def _disparities_px(words: NDArray[np.int16], pixels: NDArray[np.float32]) -> Array:
    """Median of the words of 3x3 pixels; -1 where some are missing or disagree."""
    height, width = words.shape
    u, v = np.rint(pixels).astype(int).T
    u, v = np.clip(u, 1, width - 2), np.clip(v, 1, height - 2)
    around = np.stack([words[v + dv, u + du] for dv in (-1, 0, 1) for du in (-1, 0, 1)], axis=1)
    spread = around.max(axis=1) - around.min(axis=1)
    sure = (around.min(axis=1) >= 0) & (spread <= WORD_SPREAD_PX * WORDS_PER_PX)
    return np.where(sure, np.median(around, axis=1) / WORDS_PER_PX, -1.0)
