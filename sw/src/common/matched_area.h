/* The part of the image that the engine matches. */
#ifndef VISTA_SRC_MATCHED_AREA_H
#define VISTA_SRC_MATCHED_AREA_H

#include "common/numbers.h"
#include "vista/status.h"

/* Where the engine can find a disparity, and how large a one (contract, step 2). */
typedef struct vista_matched_area {
  double disparity_max_px; /* num_disparities - 1: what is nearer is in the blind zone */
  double margin_left_px;   /* columns at the left without disparity: num_disparities - 1 + r */
  double margin_px;        /* rows and columns at the other sides: r = (block_size - 1) / 2 */
} vista_matched_area;

/* VISTA_ERROR_RANGE: a number that no engine has. */
static inline vista_status vista_matched_area_check(const vista_matched_area *area) {
  const bool good = vista_positive(area->disparity_max_px) && vista_not_negative(area->margin_left_px) &&
                    vista_not_negative(area->margin_px) &&
                    area->disparity_max_px + area->margin_left_px + area->margin_px < 1e6;
  return good ? VISTA_OK : VISTA_ERROR_RANGE;
}

#endif
