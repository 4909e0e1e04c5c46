"""The families, and which of them nothing may be chosen on.

The split was written down before any detector had flown any of them; a family that development lacked was
added to dev later, which leaves every other flight as it is. Nobody looks at results of a flight of the test
families but through a scoring, of which every one is logged (`vista_eval.metrics.scoring_log`). Each finding
that development needs has a family of its own in dev, and one of other content in test. What the two scorings
of test told went into development; the families of test2 were written after that and are of other kinds."""

from __future__ import annotations

from vista_eval.worlds.courses import ANY, FROM_AFAR, LOW
from vista_eval.worlds.sampled import (
    buildings,
    clear,
    containers,
    fences,
    machines,
    movers,
    poles,
    rows,
    second_test,
    small_movers,
    smooth_fronts,
    steep_wires,
    terrain,
    trees,
    wires,
)
from vista_eval.worlds.sampled.family import Family

COUNT, SEED = 7, 1  # flights of each family, and the set that is frozen

DEV = (
    Family("hillside", "slope ahead", "dev", terrain.hillside, terrain.OVER_SLOPE),
    Family("ridge", "ridge ahead", "dev", terrain.ridge, terrain.OVER_SLOPE),
    Family("plain_wall", "plain wall", "dev", buildings.plain_wall, buildings.AT_BUILDINGS),
    Family("repeated_windows", "repeated windows", "dev", buildings.repeated_windows, buildings.AT_BUILDINGS),
    Family("stone_house", "textured house", "dev", buildings.stone_house, buildings.AT_BUILDINGS),
    Family("containers", "stacked containers", "dev", containers.containers, containers.AT_STACKS),
    Family(
        "smooth_front", "panes or painted steel", "dev", smooth_fronts.smooth_front, smooth_fronts.AT_FRONTS
    ),
    Family("leafy", "leafy tree", "dev", trees.leafy, trees.AMONG_TREES),
    Family("poles", "pole or sign", "dev", poles.poles, FROM_AFAR),
    Family("cable", "wires between poles", "dev", wires.cable, wires.AT_WIRES),
    Family("steep_wire", "stay or tether", "dev", steep_wires.steep_wire, steep_wires.AT_STEEP_WIRES),
    Family("fence", "fence or hedge, low flight", "dev", fences.fence, LOW),
    Family("road_vehicle", "vehicle, low flight", "dev", movers.road_vehicle, movers.OVER_A_ROAD),
    Family("drone", "drone", "dev", movers.drone, ANY),
    Family("rows", "between rows of posts and trees", "dev", rows.rows, rows.BETWEEN_ROWS),
    Family(
        "small_movers", "small things that fly", "dev", small_movers.small_movers, small_movers.IN_THE_AIR
    ),
    Family(
        "clear_rolling",
        "rolling country, no obstacle",
        "dev",
        terrain.clear_rolling,
        terrain.CLEAR_HEIGHT,
        clear=True,
    ),
    Family("clear_suburb", "suburb, no obstacle", "dev", clear.clear_suburb, clear.AMONG_HOUSES, clear=True),
)

TEST = (
    Family("valley_side", "slope met askew", "test", terrain.valley_side, terrain.ALONG_SLOPE),
    Family("quarry", "rock face", "test", terrain.quarry, terrain.OVER_SLOPE),
    Family("hall", "hall of sheet metal or slabs", "test", buildings.hall, buildings.AT_BUILDINGS),
    Family("glass_front", "dark glass", "test", buildings.glass_front, buildings.AT_BUILDINGS),
    Family("corner", "corner of a building", "test", buildings.corner, buildings.AT_BUILDINGS),
    Family("bare", "leafless tree", "test", trees.bare, trees.AMONG_TREES),
    Family("pine_wood", "trunk in a wood", "test", trees.pine_wood, trees.AMONG_TRUNKS),
    Family("tower", "chimney, silo or tower", "test", poles.tower, FROM_AFAR),
    Family("guyed_mast", "mast with guy wires", "test", poles.guyed_mast, FROM_AFAR),
    Family("power_line", "wires at all angles", "test", wires.power_line, wires.AT_WIRES),
    Family("steel_fence", "railing or chain link, low flight", "test", fences.steel_fence, LOW),
    Family("crane", "crane", "test", machines.crane, ANY),
    Family("scaffolding", "scaffolding", "test", machines.scaffolding, ANY),
    Family("birds", "birds", "test", movers.birds, ANY),
    Family(
        "clear_crest",
        "over a crest, no obstacle",
        "test",
        terrain.clear_crest,
        terrain.CLEAR_HEIGHT,
        clear=True,
    ),
    Family(
        "clear_valley",
        "along a valley, no obstacle",
        "test",
        terrain.clear_valley,
        terrain.CLEAR_HEIGHT,
        clear=True,
    ),
    Family(
        "clear_wood", "ride through a wood, no obstacle", "test", trees.clear_wood, trees.RIDE, clear=True
    ),
    Family(
        "clear_site",
        "between cranes and wires, no obstacle",
        "test",
        clear.clear_site,
        clear.AMONG_HOUSES,
        clear=True,
    ),
)

TEST2 = second_test.TEST2

FAMILIES: dict[str, Family] = {family.name: family for family in (*DEV, *TEST, *TEST2)}
