/* The rig: the rectified cameras, and how raw pairs are rectified. `vista prepare` writes its file, whose layout
 * vista/flight_files.py describes. */
#ifndef VISTA_FLY_RIG_H
#define VISTA_FLY_RIG_H

#include <stddef.h>
#include <stdint.h>

#include "problem.h"
#include "vista/correction.h"
#include "vista/frontend.h"
#include "vista/types.h"

#define RIG_BASELINE_IMPLAUSIBLE 1u /* in findings */
#define RIG_CALIBRATION_MISFIT 2u

typedef enum rig_kind { RIG_PASSTHROUGH = 0, RIG_MAP, RIG_GRID } rig_kind;

/* How one camera's images are rectified: by a map, by a control grid, or not at all. */
typedef vista_right_table rig_table;

typedef struct rig {
  vista_camera camera; /* rectified; raw images have its size */
  rig_kind kind;
  int32_t rectify_rows;
  uint32_t findings;
  double left_from_rectified[9]; /* the rotation of the rectified left camera in the raw one */
  vista_raw_camera right; /* as calibrated */
  rig_table tables[2]; /* left, right: as calibrated */
  void *memory; /* of the tables */
} rig;

/* Reads a rig and checks all of it: no table leads outside of what it may. */
bool rig_read(const char *path, rig *r, problem *p);

/* The rectified image of a raw one without gaps between its rows. */
void rig_rectify(const rig *r, const rig_table *table, const uint8_t *raw, uint8_t *out);

/* The pose of the rectified left camera from that of the raw one. */
vista_pose rig_rectified_pose(const rig *r, const vista_pose *raw);

void rig_free(rig *r);

#endif
