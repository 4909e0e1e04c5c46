"""The families of worlds that are flown in the loop."""

from __future__ import annotations

from vista_eval.closed_loop.places import boxes, city, dodge, forests, wide
from vista_eval.closed_loop.world import Family

CLEAR = ("clear", "wide_clear")  # families with nothing in the way
FAMILIES: dict[str, Family] = {
    family.name: family
    for family in (
        Family("boxes", "boxes of the SBFT and ICST competition", boxes.build, fixed=len(boxes.PUBLISHED)),
        Family("poisson", "trees as a Poisson process, 0.0625 a square metre", forests.build_poisson),
        Family("forest", "lanes and poles in the forest of ICST 2027", forests.build_forest),
        Family("dodge_static", "DodgeDrone, boxes at rest", dodge.build_static),
        Family("dodge", "DodgeDrone, boxes at rest and in motion", dodge.build),
        Family("city", "street with gates, cranes, lamps and wires", city.build),
        Family("wires", "street with three level wires in the way", city.build_wires),
        Family("clear", "boxes beside the route, nothing in the way", boxes.build_clear),
        Family(
            "wide_street", "wide street with slabs, towers, chimneys, cranes", wide.build_street, wide=True
        ),
        Family("forest_edge", "edge of a wood, spits of it in the way", wide.build_edge, wide=True),
        Family("wide_clear", "wide street, nothing in the way", wide.build_clear, wide=True),
    )
}
