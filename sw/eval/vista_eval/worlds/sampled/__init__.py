"""Sampled worlds: families of content, of which every seed makes another flight.

    Family (content, course, sensor, light: each drawn from stated distributions) -> seed -> Flight

The flight's path leads through the world's point (0, 0, altitude) along +x; what a family puts in the way
stands there. `catalog` names the families and which of them nothing may be chosen on.
"""
