/* The part of the image that the engine matches. */
#ifndef VISTA_SRC_MATCHED_AREA_H
#define VISTA_SRC_MATCHED_AREA_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/types.h"

/* The part of the image in which the engine can find a disparity, and how large a one (contract, step 2). A coarser
 * level of the pyramid matches what is nearer, within margins of as many pixels of its own. */
typedef struct vista_matched_area {
  double disparity_max_px; /* (num_disparities - 1) 2^coarser_levels: what is nearer is in the blind zone */
  double margin_left_px;   /* of level 0: columns at the left without disparity, num_disparities - 1 + r */
  double margin_px;        /* of level 0: rows and columns at the other sides, r = (block_size - 1) / 2 */
  int32_t coarser_levels;  /* that are matched, too */
} vista_matched_area;

typedef struct vista_margins {
  double left_px, other_px;
} vista_margins;

/* The largest disparity that the full resolution matches, px. */
static inline double vista_matched_finest_px(const vista_matched_area *area) {
  return area->disparity_max_px / (1 << area->coarser_levels);
}

/* The margins around what can be matched at a disparity: those of the finest level that has it. */
static inline vista_margins vista_matched_margins(const vista_matched_area *area, double disparity_px) {
  double scale = 1.0, rim = 0.0, largest_px = vista_matched_finest_px(area);
  for (int32_t k = 0; k < area->coarser_levels && disparity_px > largest_px; ++k) {
    scale *= 2.0;
    largest_px *= 2.0;
    rim = 2.0; /* the words at a coarser level's rim have too little support */
  }
  return (vista_margins){scale * (area->margin_left_px + rim), scale * (area->margin_px + rim)};
}

/* Whether a pixel at a disparity is inside of these margins. */
static inline bool vista_matched_holds(const vista_matched_area *area, const vista_camera *camera, double u_px,
                                       double v_px, double disparity_px) {
  const vista_margins margins = vista_matched_margins(area, disparity_px);
  return u_px >= margins.left_px && u_px <= camera->width_px - 1 - margins.other_px && v_px >= margins.other_px &&
         v_px <= camera->height_px - 1 - margins.other_px;
}

#endif
