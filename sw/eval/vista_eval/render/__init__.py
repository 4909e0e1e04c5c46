"""Renders flights: scene and trajectory become radiance, then images of a sensor, with exact truth.

Frames of reference: *world* z up, origin on the ground below the obstacle, the aircraft flies towards +x;
*body* x forward, y left, z up, its origin midway between the cameras; *camera* x right, y down, z forward.
"""
