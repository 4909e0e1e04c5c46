"""DodgeDrone 2022: boxes at rest and in motion in a room of 60 x 20 x 10 m without walls.

Boxes a square metre, as published (uzh-rpg/agile_flight): 0.11 and 0.21 at rest over x 0 to 60 and 0.21 more
over 40 to 60; 0.11 that move by up to 1 m/s along each axis over 20 to 60, and 0.11 that are accelerated over
40 to 60. Start and goal are clear for 3 m.

Differences: the originals are scaled by 0.1 to 3 from meshes of about a metre of which most lie outside of
the flown height; here every box has its middle within the room and sides of 0.1 to 1.5 m, so that about as
much of the room is taken. What is accelerated there moves evenly here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vista_eval.closed_loop.places import parts
from vista_eval.closed_loop.world import World
from vista_eval.render.scene import Thing, thing
from vista_eval.worlds import rods, things
from vista_eval.worlds.draws import draws, seed_of
from vista_eval.worlds.triangles import placed

ROOM_M = (60.0, 20.0, 10.0)
CLEAR_M, HEIGHT_M = 3.0, 5.0
SIDE_M = (0.1, 1.5)
STILL = ((0.11, 0.0), (0.21, 0.0), (0.21, 40.0))  # boxes a square metre, from x on
MOVING = ((0.11, 20.0), (0.11, 40.0))


def build(number: int, seed: int, speed_m_s: float | None) -> World:
    return made("dodge", STILL, MOVING, number, seed, speed_m_s)


def build_static(number: int, seed: int, speed_m_s: float | None) -> World:
    return made("dodge_static", STILL, (), number, seed, speed_m_s)


def made(
    family: str,
    still: tuple[tuple[float, float], ...],
    moving: tuple[tuple[float, float], ...],
    number: int,
    seed: int,
    speed_m_s: float | None,
) -> World:
    own = seed_of(seed, family, number)
    rng = draws(own, "boxes")
    standing: list[Thing] = []
    for groups, moves in ((still, False), (moving, True)):
        for density, from_m in groups:
            for _ in range(round(density * (ROOM_M[0] - from_m) * ROOM_M[1])):
                one = box(f"box{len(standing)}", from_m, moves, rng)
                if one is not None:
                    standing.append(one)
    scene = parts.scene(own, str(rng.choice(["apron", "gravel", "pasture"])), standing, (-8, 75), (-16, 16))
    start, goal = (0.0, 0.0, HEIGHT_M), (ROOM_M[0], 0.0, HEIGHT_M)
    return World(
        f"{family}_{number:03d}", family, scene, (start, goal), speed_m_s or 5.0, room_m=0.8, seed=own
    )


def box(name: str, from_m: float, moves: bool, rng: np.random.Generator) -> Thing | None:
    """None where start or goal have to be clear."""
    middle = rng.uniform([from_m, -ROOM_M[1] / 2, 0.5], [ROOM_M[0], ROOM_M[1] / 2, ROOM_M[2]])
    size, turn = rng.uniform(*SIDE_M, 3), float(rng.uniform(0, 360))
    velocity = rng.uniform(-1, 1, 3) * [1.0, 1.0, 0.3] if moves else np.zeros(3)
    room = CLEAR_M + float(np.linalg.norm(size)) / 2
    if any(np.linalg.norm(middle - [x, 0.0, HEIGHT_M]) < room for x in (0.0, ROOM_M[0])):
        return None
    shape = placed(parts.grid_box(size, turn, rng), middle)
    one = thing(name, "box", [things.mesh(name, shape)])
    return replace(one, velocity_m_s=rods.point(velocity)) if moves else one
