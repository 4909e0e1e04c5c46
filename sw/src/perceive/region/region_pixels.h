/* The pixels of a region's cells that are its own: their number, moments and bounding box. Internal to libvista. */
#ifndef VISTA_SRC_REGION_PIXELS_H
#define VISTA_SRC_REGION_PIXELS_H

#include "common/plane_fit.h"
#include "perceive/region/region.h"
#include "perceive/region/region_boundary.h"

/* Finds, of the pixels that the image gives to the region, those on its surface; of cells without a disparity all
 * that the image gives. view->pixels marks them. */
void vista_region_find_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

/* Keeps, of the pixels that were found last, those whose like is on the surface boundary_px to the left and to the
 * right, too; of cells without a disparity all. */
void vista_region_keep_inner_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

#endif
