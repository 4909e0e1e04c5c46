/* Regions of the partition with the statistics of their boundary (paper, section II-D).
 *
 * Boundary nodes of region k are the nodes of k with an edge of the whole graph that leaves k, and those within
 * boundary_px of one: cells of the fovea are far smaller than the block that the engine matches. The edge consistency
 * constraint says that a true object boundary has smoothly varying disparity; everything here about disparity is
 * taken from the valid pixels under boundary nodes, with robust statistics: the far side pollutes boundary cells.
 *
 * Figure and ground: a depth edge belongs to the nearer of its two sides, and block matching widens that side by half
 * a block. A region that grew from no disparity of its own (segmentation->obstacle_count) is therefore often the
 * background of what stands before it. Its few words are those of its neighbours, so its verdict is unknown. A plain
 * region is the exception: its left edge, its right edge and the ground that it stands on agree on one depth
 * (region_outline.c).
 *
 * Two surfaces compete for each region: facing the camera, d = mode of the boundary pixels, and a plane,
 * d = a + slope_u u + slope_v v, fitted to the region's cells; the plane has to explain a tenth more of their area.
 * Edge consistency is judged on the residuals from the winner: a wall seen at an angle varies smoothly, too. It is one
 * piece of the evidence that is summed as log-odds (vista_region_evidence).
 *
 * Size and centre are measured on the region's own pixels: the pixels of its cells that the outline in the image gives
 * to it as well (refinement.h), and that lie on its surface or in cells without disparity. At a thin post most pixels of
 * a cell belong to the background. In a long region a pixel on the surface counts only if pixels like it are found
 * boundary_px to its left and to its right, because matching widens a mast to a multiple of its width. */
#ifndef VISTA_REGION_H
#define VISTA_REGION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/arena.h"
#include "common/team.h"
#include "perceive/cells/cells.h"
#include "perceive/cells/foveation.h"
#include "perceive/cells/surface.h"
#include "perceive/cut/refinement.h"
#include "perceive/frame_view.h"
#include "vista/obstacle.h"
#include "vista/status.h"

/* Log-odds that a region is an obstacle, and not ground or matched by chance: what each piece of evidence adds. */
typedef struct vista_region_evidence {
  double height;   /* shares of the words that stand above the ground, and well above it */
  double boundary; /* edge consistency: share of the boundary's words on one surface (paper, section II-D) */
  double support;  /* share of the boundary's pixels that have a word */
  double size;     /* in metres */
  double lean;     /* of its surface, beyond VISTA_HORIZONTAL_DEG */
  double origin;   /* grown from no disparity of its own */
  double sum;      /* with the prior */
} vista_region_evidence;

typedef struct vista_region {
  int32_t label;
  vista_region_verdict verdict;
  bool plain; /* no disparity inside: the upright surface that its outline tells */
  double foot_sigma_px; /* of the disparity of a plain one, by where its foot is: the same in each frame */
  int32_t node_count;
  int32_t pixel_count; /* own pixels, see above; like their moments measured only if the boundary passed its tests */
  int32_t volume_pixels; /* on the surface and in the collision volume (collision_volume.h) */
  bool met;              /* the volume touches it, there: */
  double met_camera_m[3];
  double met_sigma_m; /* of the range of that point, an error that lasts */
  /* Moments of the own pixels: centre and covariance. */
  double mean_u_px, mean_v_px;
  double cov_uu_px2, cov_uv_px2, cov_vv_px2;
  int32_t min_u_px, min_v_px, max_u_px, max_v_px; /* bounding box, inclusive */
  /* Boundary disparity. */
  int32_t boundary_pixels;         /* pixels under boundary nodes */
  int32_t boundary_valid;          /* of these, with a valid disparity */
  int32_t boundary_inliers;        /* of these, within the tolerance of the mode */
  double disparity_px;             /* of the surface at the centre, refined by the mean residual of the inliers */
  double disparity_sigma_px;       /* standard deviation of the inliers */
  double slope_u, slope_v;         /* gradient of the disparity over the region, px per px */
  double inclination_deg;          /* of the region's surface against the vertical; 90 = horizontal; NaN: its
                                      disparities span less than the tolerance, so nothing tells */
  double valid_fraction;           /* of its pixels, with a valid disparity */
  double standing_fraction;        /* of its words, at least min_height_m above the ground */
  double top_fraction;             /* and at least top_height_m above it */
  vista_region_evidence evidence;
  bool foot_seen;    /* the ground is known, and the region is accepted: */
  double foot_share; /* height of its foot above the ground over that of the camera: 0 stands on it, 1 is as high */
} vista_region;

/* Disparity of the region's surface at a pixel. */
static inline double vista_region_surface_px(const vista_region *region, double u_px, double v_px) {
  return region->disparity_px + region->slope_u * (u_px - region->mean_u_px) +
         region->slope_v * (v_px - region->mean_v_px);
}

typedef struct vista_regions {
  vista_region *items;
  int32_t count;
  int32_t accepted_count;
  int32_t *first_member; /* nodes of region k are members[first_member[k] .. first_member[k + 1]) */
  int32_t *members;
  int32_t *queue;    /* scratch, node_count: breadth first from the boundary */
  uint8_t *boundary; /* scratch, node_count */
  float *depth_px;   /* scratch, node_count: distance from the boundary, where that is within reach */
  uint32_t *bins[VISTA_MOST_WORKERS];  /* scratch: two histograms of engine words */
  int16_t *pixels[VISTA_MOST_WORKERS]; /* scratch: a number for each pixel of one region */
  vista_team *team; /* null: the calling thread alone; set before the layout */
} vista_regions;

/* regions: zeroed, but for the team. */
vista_status vista_regions_layout(vista_regions *regions, vista_arena *arena, const vista_foveation *foveation);

/* The regions of a frame as its cells and its pixels tell them. Of the regions, 0 .. obstacle_count - 1 grew from
 * obstacle seeds. */
typedef struct vista_partition {
  const int32_t *region_of_cell; /* negative: none */
  int32_t region_count, obstacle_count;
  const vista_refinement *drawn;
} vista_partition;

void vista_regions_compute(const vista_frame_view *frame, const vista_cells *cells, const vista_surfaces *surfaces,
                           const vista_partition *partition, vista_regions *regions);

#endif
