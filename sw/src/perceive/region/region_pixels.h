/* The pixels of a region's cells that are its own: their number, moments and bounding box. Internal to libvista. */
#ifndef VISTA_SRC_REGION_PIXELS_H
#define VISTA_SRC_REGION_PIXELS_H

#include "common/plane_fit.h"
#include "perceive/region/region.h"
#include "perceive/region/region_boundary.h"

/* Which of a cell's pixels are its region's own (vista_region_view.own): VISTA_SOME_PIXELS are those that view->pixels
 * marks. */
enum { VISTA_NO_PIXEL, VISTA_ALL_PIXELS, VISTA_SOME_PIXELS };

/* Finds, of the pixels that the image gives to the region, those on its surface; of cells without a disparity all
 * that the image gives. view->pixels marks them. */
void vista_region_find_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

/* Keeps, of the pixels that were found last, those whose like is on the surface boundary_px to the left and to the
 * right, too; of cells without a disparity all. */
void vista_region_keep_inner_pixels(const vista_region_view *view, const vista_plane *surface, vista_region *region);

#endif
