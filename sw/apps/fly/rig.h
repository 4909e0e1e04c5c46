/* The rig: the rectified cameras, and how raw pairs are rectified. `vista prepare` writes its file, whose layout
 * vista/flight_files.py describes. */
#ifndef VISTA_FLY_RIG_H
#define VISTA_FLY_RIG_H

#include <stddef.h>
#include <stdint.h>

#include "problem.h"
#include "vista/frontend.h"
#include "vista/types.h"

#define RIG_BASELINE_IMPLAUSIBLE 1u /* in findings */
#define RIG_CALIBRATION_MISFIT 2u

typedef enum rig_kind { RIG_PASSTHROUGH = 0, RIG_MAP, RIG_GRID } rig_kind;

typedef struct rig_offset {
  int16_t u, v;
} rig_offset;

/* How one camera's images are rectified. */
typedef struct rig_table {
  const rig_offset *whole; /* of a map: height * width pixels of the source */
  const uint16_t *fraction; /* of a map: 32 * v + u in 1/32 px */
  const vista_frontend_offset *grid; /* of a control grid */
} rig_table;

typedef struct rig {
  vista_camera camera; /* rectified; raw images have its size */
  rig_kind kind;
  int32_t rectify_rows;
  uint32_t findings;
  double left_from_rectified[9]; /* the rotation of the rectified left camera in the raw one */
  rig_table tables[2]; /* left, right */
  void *memory; /* of the tables */
} rig;

/* Reads a rig and checks all of it: no table leads outside of what it may. */
bool rig_read(const char *path, rig *r, problem *p);

/* The rectified image of a raw one without gaps between its rows; side: 0 left, 1 right. */
void rig_rectify(const rig *r, int side, const uint8_t *raw, uint8_t *out);

/* The pose of the rectified left camera from that of the raw one. */
vista_pose rig_rectified_pose(const rig *r, const vista_pose *raw);

void rig_free(rig *r);

#endif
