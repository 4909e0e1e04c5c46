/* What a region is judged by: its boundary, its words, its pixels and its outline. Internal to libvista. */
#ifndef VISTA_SRC_REGION_BOUNDARY_H
#define VISTA_SRC_REGION_BOUNDARY_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "common/median.h"
#include "common/plane_fit.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/frame_view.h"
#include "perceive/region/region.h"
#include "vista/parameters.h"
#include "vista/types.h"
#include "vista/word.h"

#define VISTA_BOUNDARY_PX 5.0 /* cells this near to a cell on the boundary belong to it: half the matching block */
/* A region with fewer valid pixels cannot be judged by them: it is unknown. */
#define VISTA_REGION_VALID_MIN_FRACTION 0.15
#define VISTA_WORD_BINS (INT16_MAX + 1) /* one a valid word: those of coarser levels reach that far */
#define VISTA_ALL_WORDS (UINT16_MAX + 1) /* with the negative ones, which are invalid */

/* What the statistics of one region read. */
typedef struct vista_region_view {
  const vista_frame_view *frame;
  const vista_foveation *foveation;
  const vista_region_params *params;
  const vista_cells *cells;
  const vista_surfaces *surfaces;
  const int32_t *region_of_listed; /* a pixel of the mixed nodes, as the foveation lists them */
  const uint8_t *boundary; /* a node */
  const uint8_t *mixed;    /* a node: some of its pixels may be another region's */
  uint32_t *bins;          /* 2 VISTA_ALL_WORDS; those of valid words are zero between calls */
  int16_t *pixels;         /* scratch: as many as the image has, and VISTA_WORD_BLOCK more */
  const int32_t *members;
  int32_t member_count;
  double tolerance_px; /* at the region's disparity */
} vista_region_view;

static inline double vista_plane_at(const vista_plane *plane, double u_px, double v_px) {
  return plane->offset + plane->slope_u * u_px + plane->slope_v * v_px;
}

/* Whether no word of a cell is within the tolerance of a plane, told without looking at each: from the range of the
 * words and that of the plane over the cell, with a margin for rounding. False may mean that none is, all the same. */
static inline bool vista_cell_off_plane(const vista_region_view *view, const vista_plane *plane, double tolerance_px,
                                        int32_t node) {
  const vista_foveation *const f = view->foveation;
  const vista_word_range range = view->cells->range[node];
  const double unit = 1.0 / VISTA_DISPARITY_SCALE, around_px = (double)f->size_px[node] + 2.0;
  const double at = vista_plane_at(plane, (double)f->center_u[node], (double)f->center_v[node]);
  const double off = tolerance_px + 2.0 * unit + (fabs(plane->slope_u) + fabs(plane->slope_v)) * around_px;
  return range.valid == 0 || range.most * unit < at - off || range.least * unit > at + off;
}

/* How far a disparity may be off the surface of a region at disparity_px: by noise or by relief. */
double vista_region_tolerance_px(const vista_camera *camera, double disparity_px);

/* Centre of the window of width 2 tolerance that holds most words of view->bins, none smaller than `low` or larger than
 * `top`; the window grows with the disparity. 0: none. */
double vista_region_mode_px(const vista_region_view *view, int32_t low, int32_t top);

/* Fills the boundary's statistics in, the disparity as that at the region's first cell, and the surface; sets the
 * view's tolerance. False: no valid pixel there. */
bool vista_region_measure_boundary(vista_region_view *view, vista_region *region, vista_plane *surface);

/* region_evidence.c */
/* Fills region->evidence in: the log-odds that each piece contributes. The boundary must have been measured. */
void vista_region_weigh(const vista_region_view *view, bool seeded, vista_region *region);

/* region_pixels.c */
/* Finds, of the pixels that the image gives to the region, those on its surface; of cells without a disparity all
 * that the image gives. view->pixels marks them. */
void vista_region_find_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

/* Keeps, of the pixels that were found last, those whose like is on the surface boundary_px to the left and to the
 * right, too; of cells without a disparity all. */
void vista_region_keep_inner_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

/* region_outline.c */
/* Whether region->label, which grew from no disparity of its own, owns its outline. It does when there is an upright
 * surface such that
 * - more than outline_fraction of what is visible of the region's foot lies on it, within foot_m of the ground's plane;
 * - at least that share of its upper edge lies on it, or of its left and of its right edge; one of these two may be
 *   outside of what is matched, if two thirds of the foot lie on it;
 * - it reaches min_height_m above the ground's plane, and hardly beneath it.
 * Then the region becomes plain and *surface is that surface, over pixels from (0, 0). The disparity and the boundary
 * statistics of the region are those of the outline on it, in pixels along it. Arcs to cells of the same label are
 * inside. */
bool vista_region_owns_outline(vista_region_view *view, const int32_t *label, vista_region *region,
                               vista_plane *surface);

#endif
