"""The range of a line that words say nothing of, from where the camera has been."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np
import pytest
from random_seed import seeded
from scipy.spatial.transform import Rotation
from thin_cases import BASELINE_M, CENTER, FOCAL_PX, HEIGHT, WIDTH, Thin, Wire, wire_at, with_wire
from vista.engine import INVALID

Path = list[tuple[float, float, float]]  # of the camera: right, down, forward, in metres
WALL_M = 22.0
FORWARD: Path = [(0.0, 0.0, 0.5 * k) for k in range(6)]
NO_WORDS = np.full((HEIGHT, WIDTH), INVALID, np.int16)


def seen_from(wire: Wire, at_m: tuple[float, float, float]) -> Wire:
    return Wire(wire.middle_m - np.array(at_m), wire.direction, wire.diameter_m, wire.grey)


def sky(at_m: tuple[float, float, float]) -> np.ndarray:
    return np.full((HEIGHT, WIDTH), 180.0)


def wall_of(texture: np.ndarray) -> Callable[[tuple[float, float, float]], np.ndarray]:
    """The picture of a wall square to the flight, WALL_M from where it began, as a camera sees it: `texture`
    is what it looks like from there."""

    def view(at_m: tuple[float, float, float]) -> np.ndarray:
        depth_m = WALL_M - at_m[2]
        scale = depth_m / WALL_M
        offset = CENTER - scale * CENTER + FOCAL_PX * np.array(at_m[:2]) / WALL_M
        back = np.array([[scale, 0.0, offset[0]], [0.0, scale, offset[1]]])
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        return cv2.warpAffine(texture, back, (WIDTH, HEIGHT), flags=flags, borderMode=cv2.BORDER_REFLECT)

    return view


def words_of_wall(at_m: tuple[float, float, float]) -> np.ndarray:
    return np.full((HEIGHT, WIDTH), 16 * FOCAL_PX * BASELINE_M / (WALL_M - at_m[2]), np.int16)


def no_words(at_m: tuple[float, float, float]) -> np.ndarray:
    return NO_WORDS


def fly(thin: Thin, wire: Wire, path: Path, behind=sky, words=no_words, seed: int = 1, **last) -> list:
    """What is found in the last frame."""
    random = seeded(seed)
    found: list = []
    for k, at_m in enumerate(path):
        image = with_wire(behind(at_m), seen_from(wire, at_m), random)
        found = thin.find(image, words(at_m), at_m=at_m, **(last if k + 1 == len(path) else {}))
    return found


def level(height_m: float, range_m: float = 14.0, angle_deg: float = 0.0) -> Wire:
    """A wire so far above the path, and from where it begins."""
    return wire_at(angle_deg, range_m, 0.02, y_m=-height_m)


def off_px(line, wire: Wire, at_m: tuple[float, float, float]) -> float:
    """The largest error of a line's disparity along it."""
    t = np.arange(line.first_px, line.last_px + 1.0)
    across = line.v_px + line.slope * (t - line.u_px)
    true_px = seen_from(wire, at_m).disparity_px(t, across)
    return float(np.abs(line.disparity_px + line.disparity_slope * (t - line.u_px) - true_px).max())


@pytest.mark.parametrize("before", ["sky", "a wall"])
@pytest.mark.parametrize("angle_deg", [0.0, 3.0])
def test_a_level_wire_is_found_from_where_the_camera_has_been(before: str, angle_deg: float) -> None:
    random = seeded(2)
    wire = level(random.choice([-1.0, 1.0]) * random.uniform(0.85, 1.2), angle_deg=angle_deg)
    grain = cv2.GaussianBlur(random.normal(size=(HEIGHT, WIDTH)), (0, 0), 1.5)
    wall = wall_of(150.0 + 4.0 * grain / grain.std())
    thin = Thin()
    found = fly(thin, wire, FORWARD, wall, words_of_wall) if before == "a wall" else fly(thin, wire, FORWARD)
    assert len(found) == 1
    line = found[0]
    assert line.flat and line.last_px - line.first_px > 400
    assert off_px(line, wire, FORWARD[-1]) < 2.0 * line.lasting_sigma_px < 0.2 * line.disparity_px


def test_a_camera_that_rises_finds_a_wire_straight_ahead() -> None:
    wire = level(0.0)
    path: Path = [(0.0, -0.2 * k, 0.45 * k) for k in range(6)]
    (line,) = fly(Thin(), wire, path)
    assert off_px(line, wire, path[-1]) < 2.0 * line.lasting_sigma_px


@pytest.mark.parametrize("angle_deg", [35.0, -50.0])
def test_a_camera_that_leans_over_finds_what_lay_level_before(angle_deg: float) -> None:
    """The line is as steep in the last view as it was flat in those before."""
    random, thin, wire = seeded(6), Thin(), level(1.0)
    turn = Rotation.from_euler("z", angle_deg, degrees=True).as_matrix()
    found: list = []
    for k, at_m in enumerate(FORWARD):
        seen, leans = seen_from(wire, at_m), k + 1 == len(FORWARD)
        if leans:
            seen = Wire(turn.T @ seen.middle_m, turn.T @ seen.direction, seen.diameter_m, seen.grey)
        image = with_wire(sky(at_m), seen, random)
        found = thin.find(image, NO_WORDS, at_m=at_m, turn=turn if leans else None)
    (line,) = found
    range_px = FOCAL_PX * BASELINE_M / (wire.middle_m[2] - FORWARD[-1][2])
    assert abs(line.disparity_px - range_px) < 2.0 * line.lasting_sigma_px < 0.2 * range_px


@pytest.mark.same_c
@pytest.mark.parametrize(
    ("height_m", "path"),
    [
        pytest.param(0.0, FORWARD, id="straight at it"),
        pytest.param(1.0, FORWARD[:1] * 6, id="at rest"),
        pytest.param(1.0, FORWARD[:3], id="seen from two places before"),
        pytest.param(1.0, [(0.5 * k, 0.0, 0.0) for k in range(6)], id="along the wire"),
    ],
)
def test_what_does_not_move_in_the_image_has_no_range(height_m: float, path: Path) -> None:
    assert fly(Thin(), level(height_m), path) == []


def test_poses_that_begin_anew_or_are_not_known_tell_nothing() -> None:
    wire = level(1.0)
    assert fly(Thin(), wire, FORWARD, restarted=True) == []
    random = seeded(3)
    thin = Thin()
    for at_m in FORWARD:
        image = with_wire(sky(at_m), seen_from(wire, at_m), random)
        assert thin.find(image, NO_WORDS) == []


def test_lines_on_a_surface_are_no_things_of_their_own() -> None:
    """Courses of a wall, which repeat from one to the next; the wall is matched."""
    random = seeded(4)
    v = np.arange(HEIGHT)[:, None]
    courses = np.where(v % 24 < 2, 90.0, 160.0) + np.zeros((1, WIDTH))
    nothing = wire_at(0.0, 14.0, 0.0, y_m=-1.0)
    seed = int(random.integers(1000))
    assert fly(Thin(), nothing, FORWARD, wall_of(courses), words_of_wall, seed=seed) == []


def test_lines_of_a_wall_without_words_are_where_it_is() -> None:
    """They repeat in each view, and in all views together one range alone fits."""
    v = np.arange(HEIGHT)[:, None]
    courses = np.where(v % 24 < 2, 90.0, 160.0) + np.zeros((1, WIDTH))
    nothing = wire_at(0.0, 14.0, 0.0, y_m=-1.0)
    found = fly(Thin(), nothing, FORWARD, wall_of(courses))
    assert len(found) > 4
    true_px = FOCAL_PX * BASELINE_M / (WALL_M - FORWARD[-1][2])
    for line in found:
        assert abs(line.disparity_px - true_px) < 2.0 * line.lasting_sigma_px


def test_what_is_behind_a_wire_is_not_taken_for_it() -> None:
    """A wire as near as the wall is on it, whatever its range says."""
    wire = level(1.0, WALL_M - 0.3)
    grain = cv2.GaussianBlur(seeded(5).normal(size=(HEIGHT, WIDTH)), (0, 0), 1.5)
    assert fly(Thin(), wire, FORWARD, wall_of(150.0 + 8.0 * grain / grain.std()), words_of_wall) == []


def test_the_oldest_views_make_room_for_new_ones() -> None:
    """The last of a long way is enough to find the wire."""
    wire = level(1.0, 40.0)
    path: Path = [(0.0, 0.0, 0.5 * k) for k in range(50)]
    (line,) = fly(Thin(), wire, path)
    assert off_px(line, wire, path[-1]) < 2.0 * line.lasting_sigma_px
