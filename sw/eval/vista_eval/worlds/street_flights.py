"""Flights among buildings and along a forest lane; frame and arguments as in `meadow_flights`."""

from __future__ import annotations

import numpy as np

from vista_eval.render.scene import Scene, Thing
from vista_eval.worlds import street, things, vehicle
from vista_eval.worlds.landscape import forest, tree_row
from vista_eval.worlds.meadow_flights import country, level_ground, parked

# A window pitch of 3 m shifts the disparity of a facade 120 m away to that of a thing 15 to 40 m away.
ALIASING = street.FacadeStyle(3.0, (1.5, 1.6), 0.42, 0.7, bricks=False, grain=0.4, variety=0.15)
BEYOND_CYLINDER_X_M = (
    97.0  # the collision cylinder ends 100 m before the aircraft, which stops short of x = -8
)
STREET_SUN = (-0.5, 0.25, 0.83)
TEXEL_M = 0.03


def block_across(x_m: float, half_width_m: float, floors: int, style: street.FacadeStyle, seed: int) -> Thing:
    """One long facade square to the path."""
    ends = (x_m, half_width_m, 0.0), (x_m, -half_width_m, 0.0)
    return things.house("block", *ends, street.FLOOR_M * floors + 0.8, 10.0, style, seed, texel_m=0.05)


def terrace(
    side: int, y_m: float, x_m: tuple[float, float], style: street.FacadeStyle | None, seed: int
) -> list[Thing]:
    """Houses wall to wall along the path; `side` +1 is left. Without a style each has its own."""
    rng = np.random.default_rng((seed, 20 + side))
    name = "left" if side > 0 else "right"
    row: list[Thing] = []
    x = x_m[0]
    while x < x_m[1]:
        width = float(rng.uniform(13, 24))
        near, far = (x, side * y_m, 0.0), (x + width, side * y_m, 0.0)
        ends = (near, far) if side > 0 else (far, near)
        height = street.FLOOR_M * int(rng.integers(3, 6)) + 0.8
        its = style or street.any_style(rng)
        with_balconies = bool(style is None and rng.random() < 0.35)
        house_seed = int(rng.integers(1 << 30))
        house = things.house(
            f"{name}{len(row)}", *ends, height, 9.0, its, house_seed, with_balconies, TEXEL_M
        )
        row.append(house)
        x += width
    return row


def street_furniture(seed: int, clear_of_m: float = 4.5) -> list[Thing]:
    """Lamp posts and parked cars on both sides."""
    rng = np.random.default_rng((seed, 23))
    row: list[Thing] = []
    for k, x in enumerate(np.arange(-75.0, 110.0, 24.0)):
        side, post = 1 if k % 2 else -1, street.lamp_post(float(rng.uniform(6.0, 8.0)), rng)
        turn_deg = 180.0 if side > 0 else 0.0
        row.append(things.one(f"lamp{k}", "lamp post", post, (x, side * 7.4, 0.0), turn_deg))
    for k, x in enumerate(np.arange(-82.0, 100.0, 11.0)):
        side = rng.choice([-1, 1])
        kind, paint = rng.choice(["car", "car", "car", "van"]), rng.choice([0.05, 0.15, 0.4, 0.7])
        yaw, x = 180.0 * rng.integers(2) + rng.normal(0, 2), x + rng.uniform(-3, 3)
        row.append(parked(f"parked{k}", kind, x, side * clear_of_m, yaw, paint, seed + k))
    return row


def town(altitude_m: float, seed: int, style: street.FacadeStyle | None = None) -> list[Thing]:
    """A street of houses 9.5 m to either side, closed by a facade beyond the collision cylinder."""
    return [
        level_ground("asphalt", altitude_m, seed),
        *terrace(1, 9.5, (-80.0, 95.0), style, seed),
        *terrace(-1, 9.5, (-84.0, 95.0), style, seed),
        block_across(125.0, 40.0, 5, ALIASING, seed),
        forest(190.0, seed),
    ]


def clear_street(altitude_m: float, seed: int) -> Scene:
    """A flight between houses, nothing in the way."""
    return Scene((*town(altitude_m, seed), *street_furniture(seed)), to_sun=STREET_SUN, exposure=1.2)


def urban(altitude_m: float, seed: int) -> Scene:
    """Three things in the way at once: a street tree, a lamp post, a board over the road."""
    rng = np.random.default_rng((seed, 24))
    tree = things.tree("tree", "broadleaf", (2.0, 2.6, 0.0), 1.5 * altitude_m, seed, 0.14, target=True)
    post = street.lamp_post(altitude_m + 2.2, rng)
    lamp = things.one("lamp_post", "lamp post", post, (0.0, -1.1, 0.0), 180.0, target=True)
    board = things.overhead_board("board", 22.0, 7.0, altitude_m, 2.0, seed, target=True)
    return Scene(
        (tree, lamp, board, *town(altitude_m, seed), *street_furniture(seed)), to_sun=STREET_SUN, exposure=1.2
    )


def yard_before_block(altitude_m: float, seed: int) -> list[Thing]:
    """A gravel yard that ends at a long facade with a window every 3 m."""
    return [
        level_ground("gravel", altitude_m, seed),
        block_across(BEYOND_CYLINDER_X_M, 62.0, 6, ALIASING, seed),
        parked("car0", "car", 30.0, -11.0, 85.0, 0.6, seed),
        parked("car1", "car", 34.0, 8.0, 95.0, 0.1, seed + 1),
        parked("van", "van", 60.0, 14.0, 180.0, 0.7, seed),
    ]


def sign_before_facade(altitude_m: float, seed: int) -> Scene:
    return Scene((things.sign(altitude_m, seed), *yard_before_block(altitude_m, seed)), to_sun=STREET_SUN)


def lamp_post_before_facade(altitude_m: float, seed: int) -> Scene:
    """Its grey is the facade's."""
    post = street.lamp_post(altitude_m + 3.0, np.random.default_rng((seed, 25)))
    lamp = things.one("lamp_post", "lamp post", post, target=True)
    return Scene((lamp, *yard_before_block(altitude_m, seed)), to_sun=STREET_SUN)


def clear_facades(altitude_m: float, seed: int) -> Scene:
    """The same windows to the left, to the right and ahead, nothing in the way: every alarm is false."""
    return Scene(
        (*town(altitude_m, seed, ALIASING), *street_furniture(seed)), to_sun=STREET_SUN, exposure=1.1
    )


def clear_lane(altitude_m: float, seed: int) -> Scene:
    """A forest lane, the crowns more than 4 m off the path."""
    rng = np.random.default_rng((seed, 26))
    trees: list[Thing] = []
    for side in (-1, 1):
        for x in np.arange(-82.0, 118.0, 6.5):
            form = rng.choice(["broadleaf", "conifer", "poplar"], p=[0.5, 0.4, 0.1])
            height = float(rng.uniform(7.0, 12.0))
            y = side * (4.5 + 0.42 * height + rng.uniform(0.0, 2.5))
            foot = (x + rng.uniform(-2, 2), y, 0.0)
            name, tree_seed = f"tree{len(trees)}", int(rng.integers(1 << 30))
            trees.append(things.tree(name, form, foot, height, tree_seed, 0.26))
    far = tree_row((118.0, 135.0), 60.0, seed)
    scenery = (level_ground("soil", altitude_m, seed), far, forest(185.0, seed))
    return Scene((*trees, *scenery), to_sun=(-0.35, 0.45, 0.82), exposure=1.3)


def van_in_the_way(altitude_m: float, seed: int) -> Scene:
    """A flight at 2.6 m, about as low as the van is high: it crosses slowly from the right."""
    rng = np.random.default_rng((seed, 27))
    target = things.one(
        "van", "van", vehicle.van(0.6, rng), (0.0, 0.3, 0.0), 90.0, target=True, velocity_m_s=(0.0, 0.8, 0.0)
    )
    others = (
        parked("car0", "car", 14.0, 9.0, 75.0, 0.1, seed),
        parked("car1", "car", 24.0, -9.0, 100.0, 0.5, seed),
    )
    return Scene((target, *country(altitude_m, seed, "asphalt"), *others), to_sun=STREET_SUN)
