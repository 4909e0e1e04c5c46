"""Poles, signs, towers, lattice masts with guy wires."""

from __future__ import annotations

import cv2
import numpy as np

from vista_eval.render import textures
from vista_eval.render.scene import Cylinder, Panel, Scene, Solid, Thing, thing
from vista_eval.worlds import street, things
from vista_eval.worlds.courses import FROM_AFAR
from vista_eval.worlds.draws import log_uniform, some_seed
from vista_eval.worlds.grounds import COUNTRY_AND_TOWN
from vista_eval.worlds.patterns import cloudy, laid
from vista_eval.worlds.rods import all_of, lattice, strand
from vista_eval.worlds.site import RURAL, URBAN, Site, background, clutter, scene_of, site


def cylinder_albedo(height_m: float, girth_m: float, seed: int, kind: str) -> np.ndarray:
    """Rows from one end to the other, columns around: wood, concrete, steel, or bands of paint."""
    rng = np.random.default_rng(seed)
    rows, columns = int(np.clip(height_m / 0.02, 16, 1200)), int(np.clip(girth_m / 0.02, 16, 400))
    z = (np.arange(rows, dtype=np.float32) * height_m / rows)[:, None]
    y = (np.arange(columns, dtype=np.float32) * girth_m / columns)[None, :]
    base = float(rng.uniform(0.12, 0.6))
    match kind:
        case "wood":
            shade = base * 0.6 * (1 + 0.25 * laid(cloudy(seed, 0.8, 0.1), z, y, 4.0))
        case "concrete":
            shade = base * (1 + 0.06 * laid(cloudy(seed, 0.8), z, y, 4.0) - 0.3 * (np.mod(z, 2.4) < 0.03))
        case "bands":
            band = float(rng.uniform(0.5, 3.0))
            shade = np.where(np.mod(z, 2 * band) < band, 0.08, 0.65) + 0 * y
        case _:
            shade = base * (1 + 0.015 * laid(cloudy(seed, 1.6), z, y, 9.0))
    return np.clip(shade, 0.02, 0.85).astype(np.float32)


def round_pole(name: str, foot_m: tuple, top_m: tuple, radius_m: float, seed: int, kind: str) -> Cylinder:
    height = float(np.linalg.norm(np.subtract(top_m, foot_m)))
    albedo = cylinder_albedo(height, 2 * np.pi * radius_m, seed, kind)
    return Cylinder(name, tuple(foot_m), tuple(top_m), radius_m, albedo)


def printed(width_m: float, height_m: float, seed: int) -> np.ndarray:
    """A board: letters, chevrons, a poster or one shade only; row 0 on top."""
    rng = np.random.default_rng(seed)
    rows, columns = round(100 * height_m), round(100 * width_m)
    back, ink = (0.75, 0.08) if rng.random() < 0.5 else (0.12, 0.7)
    board = cv2.resize(textures.paint(back, seed), (columns, rows), interpolation=cv2.INTER_CUBIC)
    v, u = np.mgrid[0:rows, 0:columns]
    match rng.integers(4):
        case 0:
            board[(u + np.abs(v - rows / 2)) % 60 < 30] = ink
        case 1:
            letters = np.zeros((rows, columns), np.uint8)
            for line in range(3):
                text = "".join(rng.choice(list("ABDEGHKLMNRSTUV0123456789"), 8))
                place = (columns // 12, int(rows * (0.3 + 0.28 * line)))
                cv2.putText(letters, text, place, cv2.FONT_HERSHEY_DUPLEX, columns / 210, 255, 3, cv2.LINE_AA)
            board = board + (ink - board) * (letters / 255)
        case 2:
            clouds = cv2.resize(cloudy(seed, 1.2), (columns, rows), interpolation=cv2.INTER_AREA)
            board = board + 0.12 * clouds
        case _:
            cv2.rectangle(board, (3, 3), (columns - 4, rows - 4), ink, 4)
    return np.clip(board, 0.02, 0.85).astype(np.float32)


def board_on_posts(name: str, here: Site, rng: np.random.Generator, **more) -> Thing:
    """0.8 to 4 m wide, its middle on the path, up to 40 degrees askew."""
    width, height = float(rng.uniform(0.8, 4.0)), float(rng.uniform(0.6, 2.0))
    turn, z = np.radians(rng.uniform(-40, 40)), here.altitude_m + rng.uniform(-0.4, 0.4)
    right = width / 2 * np.array([np.sin(turn), -np.cos(turn), 0.0])
    back = 0.08 * np.array([np.cos(turn), np.sin(turn), 0.0])
    albedo = printed(width, height, some_seed(rng))
    solids: list[Solid] = [
        Panel(f"{name}_board", (0.0, 0.0, z), tuple(right), (0.0, 0.0, -height / 2), albedo)
    ]
    for k, at in enumerate((-0.7, 0.7) if width > 1.5 else (0.0,)):
        x, y = (at * right + back)[:2]
        foot = here.foot_m(float(x), float(y))
        solids.append(round_pole(f"{name}_post{k}", foot, (x, y, z + height / 2), 0.05, some_seed(rng), ""))
    return thing(name, "sign", solids, **more)


def pole(name: str, here: Site, rng: np.random.Generator, **more) -> Thing:
    """A post of 3 to 30 cm, 1 to 6 m taller than the path is high; some lean, some carry a lamp."""
    foot = here.foot_m(0.0, float(rng.uniform(-0.5, 0.5)))
    height = here.altitude_m - foot[2] + float(rng.uniform(1, 6))
    if rng.random() < 0.25:
        return things.one(name, "pole", street.lamp_post(height, rng), foot, rng.choice([0.0, 180.0]), **more)
    radius, kind = log_uniform(rng, 0.03, 0.3) / 2, str(rng.choice(["wood", "concrete", "bands", "steel"]))
    lean = rng.normal(0, 0.015, 2) * height
    top = (foot[0] + lean[0], foot[1] + lean[1], foot[2] + height)
    solids: list[Solid] = [round_pole(f"{name}_pole", foot, top, radius, some_seed(rng), kind)]
    if kind == "wood" and rng.random() < 0.6:
        arm = float(rng.uniform(0.6, 1.2))
        ends = [(top[0] - 0.1, top[1] + s * arm, top[2] - 0.5) for s in (-1, 1)]
        solids.append(round_pole(f"{name}_arm", ends[0], ends[1], 0.06, some_seed(rng), "wood"))
    return thing(name, "pole", solids, **more)


def poles(altitude_m: float, seed: int) -> Scene:
    """A pole or a board on posts, alone in the way."""
    here = site(altitude_m, seed, FROM_AFAR, COUNTRY_AND_TOWN)
    rng = here.draws("pole")
    make = board_on_posts if rng.random() < 0.35 else pole
    around = [*clutter(here, (*RURAL, "thin post", "lamp post")), *background(here)]
    return scene_of(here, [make("target", here, rng, target=True)], around)


def tower(altitude_m: float, seed: int) -> Scene:
    """A chimney, a silo, a wind turbine's tower: 0.4 to 3 m in radius, mostly without texture."""
    here = site(altitude_m, seed, FROM_AFAR, COUNTRY_AND_TOWN)
    rng = here.draws("tower")
    radius = log_uniform(rng, 0.4, 3.0)
    foot = here.foot_m(radius, float(rng.uniform(-0.5, 0.5)) * radius)
    top = (foot[0], foot[1], altitude_m + float(rng.uniform(3, 25)))
    kind = str(rng.choice(["steel", "steel", "concrete", "bands"]))
    body = round_pole("target_tower", foot, top, radius, some_seed(rng), kind)
    return scene_of(
        here, [thing("target", "tower", [body], target=True)], [*clutter(here, URBAN), *background(here)]
    )


def guyed_mast(altitude_m: float, seed: int) -> Scene:
    """A lattice or a tube of 0.1 to 0.7 m, 15 to 50 m high, held by wires of 5 to 20 mm from three sides."""
    here = site(altitude_m, seed, FROM_AFAR, COUNTRY_AND_TOWN)
    rng = here.draws("mast")
    height, foot = float(rng.uniform(15, 50)), here.foot_m(0.0, float(rng.uniform(-0.4, 0.4)))
    if rng.random() < 0.6:
        side = float(rng.uniform(0.25, 0.7))
        body = lattice(height, side, 0.05 * side + 0.006, float(rng.uniform(0.1, 0.6)))
        mast = body.moved(foot).solids("target_mast")
    else:
        top = (foot[0], foot[1], foot[2] + height)
        kind = str(rng.choice(["steel", "bands"]))
        mast = [round_pole("target_mast", foot, top, float(rng.uniform(0.05, 0.2)), some_seed(rng), kind)]
    start, radius = rng.uniform(0, 2 * np.pi), log_uniform(rng, 0.0025, 0.01)
    out_m, wires = float(rng.uniform(0.4, 0.8)) * height, []
    for direction in start + np.arange(3) * 2 * np.pi / 3:
        x, y = foot[0] + out_m * np.cos(direction), foot[1] + out_m * np.sin(direction)
        for share in np.linspace(0.95, 0.35, int(rng.integers(1, 4))):
            ends = (foot[0], foot[1], foot[2] + share * height), here.foot_m(float(x), float(y))
            wires.append(strand(*ends, radius, 0.01, rng))
    target = thing("target", "mast", [*mast, *all_of(*wires).solids("target_guy")], target=True)
    return scene_of(here, [target], [*clutter(here, RURAL), *background(here)])
