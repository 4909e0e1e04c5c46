"""The families of worlds that are flown in the loop."""

from __future__ import annotations

from vista_eval.closed_loop.places import boxes, city, dodge, forests
from vista_eval.closed_loop.world import Family

CLEAR = "clear"  # the family with nothing in the way
FAMILIES: dict[str, Family] = {
    family.name: family
    for family in (
        Family("boxes", "boxes of the SBFT and ICST competition", boxes.build, fixed=len(boxes.PUBLISHED)),
        Family("poisson", "trees as a Poisson process, 0.0625 a square metre", forests.build_poisson),
        Family("forest", "lanes and poles in the forest of ICST 2027", forests.build_forest),
        Family("dodge_static", "DodgeDrone, boxes at rest", dodge.build_static),
        Family("dodge", "DodgeDrone, boxes at rest and in motion", dodge.build),
        Family("city", "street with gates, cranes, lamps and wires", city.build),
        Family(CLEAR, "boxes beside the route, nothing in the way", boxes.build_clear),
    )
}
