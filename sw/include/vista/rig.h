/* The two cameras of a vehicle, and how their raw images become a rectified pair. */
#ifndef VISTA_RIG_H
#define VISTA_RIG_H

#include <stdint.h>

#include "vista/api.h"
#include "vista/correction.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

/* Everything a detector has to know of the cameras. The tables and texts stay the caller's, and in place. */
typedef struct vista_rig {
  vista_camera camera;           /* the rectified pair; raw images have its size */
  vista_right_table tables[2];   /* left, right, as calibrated; of nulls alone: images come rectified */
  int32_t rectify_rows;          /* rows of the line buffer that the control grids were made for; 0: none */
  double left_from_rectified[9]; /* row-major rotation of the rectified left camera in the raw one */
  vista_raw_camera right;        /* as calibrated; what the correction in flight starts from */
  const char *baseline_problem, *calibration_problem; /* what is wrong with the calibration; null: nothing */
} vista_rig;

/* Writes the rectified image of a raw one, row by row without gaps. table: as in a rig or of a correction; of nulls alone
 * it is a copy. A map is followed to the bit as OpenCV's remap does, interpolating linearly and repeating the border; a
 * control grid as the engine's contract says. VISTA_ERROR_ARGUMENT: a null pointer, or out within the image.
 * VISTA_ERROR_SIZE: an image of another size than the camera's. */
VISTA_API vista_status vista_rectify(const vista_camera *camera, const vista_right_table *table, const vista_image *raw,
                                     uint8_t *out);

/* The pose of the rectified left camera from that of the raw one. */
VISTA_API vista_pose vista_rig_rectified_pose(const vista_rig *rig, const vista_pose *raw);

VISTA_END

#endif
