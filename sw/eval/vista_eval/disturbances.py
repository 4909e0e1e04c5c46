"""The vocabulary of disturbances: what becomes of the frames of a recording from a moment on.

A kind changes raw images, times and poses (`of_shot`), the words of an engine (`of_words`), or what the
detector remembers at the onset (`of_state`). It sees all frames as they were recorded, so that it can hand
over an older one. Strengths are in the unit that the kind names; the same seed disturbs in the same way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from vista.engine import INVALID, SCALE
from vista.geometry import Pose

from vista_eval.pose_noise import noisy_poses
from vista_eval.sensor_noise import noisy_image

Image = NDArray[np.uint8]
Words = list[NDArray[np.int16]]  # of each level


@dataclass(frozen=True)
class Shot:
    """One raw pair with its time and pose."""

    left: Image
    right: Image
    t_ns: int
    pose: Pose | None


@dataclass(frozen=True)
class Now:
    """What a disturbance knows of the frame that it changes."""

    shots: Sequence[Shot]  # of the whole recording, as recorded
    index: int
    onset: int  # index of the first frame that is disturbed
    strength: float
    seed: int

    @property
    def shot(self) -> Shot:
        return self.shots[self.index]

    @property
    def since(self) -> int:
        """Frames since the onset."""
        return self.index - self.onset

    def older(self, frames: float) -> Shot:
        return self.shots[max(0, self.index - round(frames))]

    def random(self, *of: int) -> np.random.Generator:
        return np.random.default_rng((self.seed, *of))


OfShot = Callable[[Now], Shot]
OfWords = Callable[[Now, Sequence[Words]], Words]  # words of all frames up to this one, as they were matched
OfState = Callable[[Now, bytes], bytes]


@dataclass(frozen=True)
class Kind:
    strengths: tuple[float, ...]
    unit: str
    of_shot: OfShot | None = None
    of_words: OfWords | None = None
    of_state: OfState | None = None


# ---- images that come again or late ----


def frozen(left: bool, right: bool) -> OfShot:
    """Sides show the frame before the onset for so many frames."""

    def change(now: Now) -> Shot:
        old = now.shots[max(0, now.onset - 1)]
        if now.since >= now.strength:
            return now.shot
        return replace(
            now.shot,
            left=old.left if left else now.shot.left,
            right=old.right if right else now.shot.right,
        )

    return change


def late(left: bool, right: bool) -> OfShot:
    """Sides show what they should have shown so many frames earlier."""

    def change(now: Now) -> Shot:
        old = now.older(now.strength)
        return replace(
            now.shot,
            left=old.left if left else now.shot.left,
            right=old.right if right else now.shot.right,
        )

    return change


# ---- what a camera shows ----


def images(change: Callable[[Now, Image, int], Image], sides: tuple[int, ...] = (0, 1)) -> OfShot:
    """change: of one image, whose side is 0 or 1."""

    def of_shot(now: Now) -> Shot:
        pair = [now.shot.left, now.shot.right]
        for side in sides:
            pair[side] = np.ascontiguousarray(change(now, pair[side], side))
        return replace(now.shot, left=pair[0], right=pair[1])

    return of_shot


def shifted(image: Image, right_px: float, down_px: float) -> Image:
    height, width = image.shape
    move = np.array([[1.0, 0.0, right_px], [0.0, 1.0, down_px]])
    return np.asarray(cv2.warpAffine(image, move, (width, height), borderMode=cv2.BORDER_REPLICATE), np.uint8)


def yawed(now: Now, image: Image, _: int) -> Image:
    return shifted(image, now.strength, 0.0)


def rows_off(now: Now, image: Image, _: int) -> Image:
    return shifted(image, 0.0, now.strength)


def rolled(now: Now, image: Image, _: int) -> Image:
    height, width = image.shape
    turn = cv2.getRotationMatrix2D((width / 2.0, height / 2.0), now.strength, 1.0)
    return np.asarray(cv2.warpAffine(image, turn, (width, height), borderMode=cv2.BORDER_REPLICATE), np.uint8)


FOG_GREY = 170.0


def fogged(now: Now, image: Image, _: int) -> Image:
    return np.rint(FOG_GREY + now.strength * (image - FOG_GREY)).astype(np.uint8)


def exposed(now: Now, image: Image, _: int) -> Image:
    return np.clip(np.rint(now.strength * image.astype(np.float32)), 0, 255).astype(np.uint8)


def blurred(now: Now, image: Image, _: int) -> Image:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), now.strength), np.uint8)


def noisy(now: Now, image: Image, side: int) -> Image:
    return noisy_image(image, now.strength, (now.seed, now.index, side))


def middle(size: int, share: float) -> slice:
    half = max(1, round(0.5 * share * size))
    return slice(size // 2 - half, size // 2 + half)


def stuck_columns(now: Now, image: Image, side: int) -> Image:
    """Columns in the middle of the width, each of a grey of its own."""
    at = middle(image.shape[1], now.strength)
    out = image.copy()
    out[:, at] = now.random(side).integers(0, 256, at.stop - at.start)
    return out


def stuck_rows(now: Now, image: Image, side: int) -> Image:
    at = middle(image.shape[0], now.strength)
    out = image.copy()
    out[at] = now.random(side).integers(0, 256, (at.stop - at.start, 1))
    return out


def black_bar(now: Now, image: Image, _: int) -> Image:
    out = image.copy()
    out[:, middle(image.shape[1], now.strength)] = 0
    return out


def dirty(now: Now, image: Image, _: int) -> Image:
    """A dark blot with a soft rim in the middle; strength: its radius as a share of the height."""
    height, width = image.shape
    v, u = np.mgrid[:height, :width]
    away = np.hypot(u - width / 2.0, v - height / 2.0) / (now.strength * height)
    cover = np.clip(2.0 * (1.0 - away), 0.0, 1.0)
    return np.rint(image * (1.0 - cover) + 40.0 * cover).astype(np.uint8)


# ---- words ----


def words_late(now: Now, words: Sequence[Words]) -> Words:
    return words[max(0, now.index - round(now.strength))]


def words_frozen(now: Now, words: Sequence[Words]) -> Words:
    return words[max(0, now.onset - 1)] if now.since < now.strength else words[now.index]


def each_level(change: Callable[[Now, NDArray[np.int16], int], NDArray[np.int16]]) -> OfWords:
    return lambda now, words: [change(now, level, k) for k, level in enumerate(words[now.index])]


def bit_stuck(value: int) -> Callable[[Now, NDArray[np.int16], int], NDArray[np.int16]]:
    def change(now: Now, words: NDArray[np.int16], _: int) -> NDArray[np.int16]:
        bit = np.int16(1 << round(now.strength))
        return np.where(words >= 0, words | bit if value else words & ~bit, words)

    return change


def filled(now: Now, words: NDArray[np.int16], level: int) -> NDArray[np.int16]:
    return np.full_like(words, round(SCALE * now.strength / 2**level))


def emptied(now: Now, words: NDArray[np.int16], _: int) -> NDArray[np.int16]:
    out = words.copy()
    out[middle(words.shape[0], now.strength), middle(words.shape[1], now.strength)] = INVALID
    return out


def upset_words(now: Now, words: NDArray[np.int16], level: int) -> NDArray[np.int16]:
    """One of the low 14 bits of this share of the words is turned over."""
    random = now.random(now.index, level)
    hit = random.random(words.shape) < now.strength
    return np.where(hit, words ^ (1 << random.integers(0, 14, words.shape)), words).astype(np.int16)


# ---- poses ----


def posed(change: Callable[[Now, Pose], Pose | None]) -> OfShot:
    return lambda now: (
        now.shot if now.shot.pose is None else replace(now.shot, pose=change(now, now.shot.pose))
    )


def direction(now: Now) -> NDArray[np.float64]:
    aim = now.random(1).standard_normal(3)
    return np.asarray(aim / np.linalg.norm(aim))


def jumped(now: Now, pose: Pose) -> Pose:
    return Pose(pose.rotation, pose.translation_m + now.strength * direction(now))


def pose_spike(now: Now, pose: Pose) -> Pose:
    return jumped(now, pose) if now.since == 0 else pose


def seconds(now: Now) -> float:
    return (now.shot.t_ns - now.shots[max(0, now.onset - 1)].t_ns) / 1e9


def drifting(now: Now, pose: Pose) -> Pose:
    return Pose(pose.rotation, pose.translation_m + now.strength * seconds(now) * direction(now))


def scaled(now: Now, pose: Pose) -> Pose:
    """The way from the onset on is told too long or too short, as a wrong baseline would have it."""
    start = now.shots[max(0, now.onset - 1)].pose
    assert start is not None
    way = pose.translation_m - start.translation_m
    return Pose(pose.rotation, start.translation_m + now.strength * way)


def turned(now: Now, pose: Pose) -> Pose:
    turn = cv2.Rodrigues(math.radians(now.strength) * direction(now))[0]
    return Pose(pose.rotation @ turn, pose.translation_m)


def late_pose(now: Now, _: Pose) -> Pose | None:
    return now.older(now.strength).pose


def repeated_pose(now: Now, pose: Pose) -> Pose | None:
    return now.shots[max(0, now.onset - 1)].pose if now.since < now.strength else pose


def missing_pose(now: Now, pose: Pose) -> Pose | None:
    return None if now.since < now.strength else pose


def filtered(now: Now, pose: Pose) -> Pose:
    """Errors like those of a navigation filter, so many times as large."""
    shots = [shot for shot in now.shots if shot.pose is not None]
    exact = [shot.pose for shot in shots if shot.pose is not None]
    erring = noisy_poses(exact, [shot.t_ns for shot in shots], now.seed)[now.index]
    error = now.strength * (erring.translation_m - pose.translation_m)
    turn = cv2.Rodrigues(pose.rotation.T @ erring.rotation)[0]
    return Pose(pose.rotation @ cv2.Rodrigues(now.strength * turn)[0], pose.translation_m + error)


def upset_pose(now: Now, pose: Pose) -> Pose:
    """So many bits of the 12 numbers are turned over in one frame."""
    if now.since > 0:
        return pose
    bits = np.concatenate([pose.rotation.ravel(), pose.translation_m]).view(np.uint64)
    random = now.random(2)
    for _ in range(round(now.strength)):
        bits[random.integers(0, bits.size)] ^= np.uint64(1) << np.uint64(random.integers(0, 64))
    numbers = bits.view(np.float64)
    return Pose(numbers[:9].reshape(3, 3), numbers[9:])


# ---- the memory of the detector ----


def upset_state(now: Now, state: bytes) -> bytes:
    """So many of its bits are turned over, wherever they lie: numbers, counts and addresses."""
    upset = np.frombuffer(state, np.uint8).copy()
    at = now.random(3).integers(0, 8 * upset.size, round(now.strength))
    np.bitwise_xor.at(upset, at // 8, (1 << (at % 8)).astype(np.uint8))
    return upset.tobytes()


# ---- clocks ----


def clock(change: Callable[[Now, float], float]) -> OfShot:
    """change: of the seconds since the frame before the onset."""

    def of_shot(now: Now) -> Shot:
        start = now.shots[max(0, now.onset - 1)].t_ns
        return replace(now.shot, t_ns=start + round(1e9 * change(now, seconds(now))))

    return of_shot


KINDS: dict[str, Kind] = {
    "both cameras frozen": Kind((1, 2, 4, 8), "frames", frozen(True, True)),
    "left camera frozen": Kind((1, 2, 4, 8), "frames", frozen(True, False)),
    "right camera frozen": Kind((1, 2, 4, 8), "frames", frozen(False, True)),
    "left camera late": Kind((1, 2, 3), "frames", late(True, False)),
    "right camera late": Kind((1, 2, 3), "frames", late(False, True)),
    "both cameras late": Kind((1, 2, 3), "frames", late(True, True)),
    "right camera turned in yaw": Kind((-5, -3, -1, 1, 3, 5), "px", images(yawed, (1,))),
    "rows off": Kind((-3, -1.5, 1, 1.5, 3, 6), "px", images(rows_off, (1,))),
    "right camera rolled": Kind((-1, 0.3, 1), "degrees", images(rolled, (1,))),
    "fog": Kind((0.5, 0.25, 0.1, 0.03), "contrast", images(fogged)),
    "exposure of both": Kind((0.25, 0.5, 2, 4), "gain", images(exposed)),
    "exposure of one": Kind((0.25, 0.5, 2, 4), "gain", images(exposed, (1,))),
    "blur of both": Kind((1, 2, 4), "px", images(blurred)),
    "blur of one": Kind((1, 2, 4), "px", images(blurred, (1,))),
    "sensor noise": Kind((4, 8, 16), "grey levels", images(noisy)),
    "columns stuck in both": Kind((0.05, 0.1, 0.3), "of the width", images(stuck_columns)),
    "columns stuck in one": Kind((0.05, 0.1, 0.3), "of the width", images(stuck_columns, (0,))),
    "rows stuck in both": Kind((0.05, 0.1, 0.3), "of the height", images(stuck_rows)),
    "black bar in both": Kind((0.1, 0.2, 0.4), "of the width", images(black_bar)),
    "dirt on both": Kind((0.1, 0.2, 0.4), "of the height", images(dirty)),
    "dirt on one": Kind((0.1, 0.2, 0.4), "of the height", images(dirty, (0,))),
    "words late": Kind((1, 2, 4), "frames", of_words=words_late),
    "words stand still": Kind((1, 2, 4, 8), "frames", of_words=words_frozen),
    "bit of words at 1": Kind((4, 5, 6, 7, 8), "bit", of_words=each_level(bit_stuck(1))),
    "bit of words at 0": Kind((4, 5, 6, 7, 8), "bit", of_words=each_level(bit_stuck(0))),
    "words of one value": Kind((0, 2, 8, 20), "px", of_words=each_level(filled)),
    "words missing in the middle": Kind((0.1, 0.2, 0.4), "of the sides", of_words=each_level(emptied)),
    "bits of words upset": Kind((1e-5, 1e-3, 1e-2, 1e-1), "of the words", of_words=each_level(upset_words)),
    "pose jumps": Kind((1, 3, 30, 300), "m", posed(jumped)),
    "pose jumps and returns": Kind((1, 3, 30, 300), "m", posed(pose_spike)),
    "pose drifts": Kind((0.5, 1, 3, 10), "m/s", posed(drifting)),
    "way told wrongly": Kind((0.5, 0.8, 1.25, 2), "times", posed(scaled)),
    "attitude jumps": Kind((1, 3, 10, 30), "degrees", posed(turned)),
    "poses late": Kind((1, 2, 4), "frames", posed(late_pose)),
    "pose repeats": Kind((1, 2, 4, 8), "frames", posed(repeated_pose)),
    "pose missing": Kind((1, 4, 8), "frames", posed(missing_pose)),
    "navigation errs": Kind((1, 3), "times", posed(filtered)),
    "bits of pose upset": Kind((1, 2, 4), "bits", posed(upset_pose)),
    "bits of the memory upset": Kind((1, 3, 10), "bits", of_state=upset_state),
    "time runs wrongly": Kind((0.5, 0.8, 1.25, 2), "times", clock(lambda now, s: now.strength * s)),
    "time jumps": Kind((-10, -0.15, 0.3, 10), "s", clock(lambda now, s: s + now.strength)),
    "time jumps and returns": Kind(
        (-0.15, 0.3, 10), "s", clock(lambda now, s: s + (now.strength if now.since == 0 else 0.0))
    ),
    "grain": Kind((0.5, 1), "grey levels", images(noisy)),
}
CONTROL = "grain"  # no fault: what becomes of warnings when an image is a little different
