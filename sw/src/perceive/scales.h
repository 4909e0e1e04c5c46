/* Quantities that several steps go by, internal to libvista. */
#ifndef VISTA_SRC_SCALES_H
#define VISTA_SRC_SCALES_H

#define VISTA_HALF_BLOCK_PX2 60.0 /* half of the engine's matching block: words of less than that are one observation */
#define VISTA_SURFACE_PX 1.0 /* words of one surface are off it by this at most */
#define VISTA_FARTHEST_PX 1.0 /* smaller disparities say nothing of a place */
#define VISTA_RELIEF_M 0.5 /* a step of less depth is none: near things have relief; at most 6 % of the range */
#define VISTA_SLOPE_POINTS 6 /* fewer do not tell a slope from noise */
#define VISTA_GROUND_PX 0.5 /* what is within this of the ground's plane lies on it */
#define VISTA_GROUND_SHARE 0.05 /* of its disparity, by which a road is off a plane */

#endif
