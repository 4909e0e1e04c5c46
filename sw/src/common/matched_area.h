/* The part of the image that the engine matches. */
#ifndef VISTA_SRC_MATCHED_AREA_H
#define VISTA_SRC_MATCHED_AREA_H

/* Where the engine can find a disparity, and how large a one (contract, step 2). */
typedef struct vista_matched_area {
  double disparity_max_px; /* num_disparities - 1: what is nearer is in the blind zone */
  double margin_left_px;   /* columns at the left without disparity: num_disparities - 1 + r */
  double margin_px;        /* rows and columns at the other sides: r = (block_size - 1) / 2 */
} vista_matched_area;

#endif
