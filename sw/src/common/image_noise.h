/* The noise of an image, from the image itself: what a threshold on grey levels is measured against.
 *
 * The second differences along rows and along columns at once, I * [1 0 -2 0 1]^T [1 0 -2 0 1], cancel shading and
 * straight edges along either axis; what is left where the scene is flat is noise (Immerkaer, "Fast noise variance
 * estimation", 1996, with a pixel between its taps: rectification averages neighbouring pixels, and would hide the
 * noise from the nearest ones). Texture adds to it, never takes away. So the mean absolute response is taken block by
 * block, and the noise is that of the flat blocks: a low quantile of all, corrected for what the choice of the quietest
 * takes off. Blocks with clipped pixels, a burnt-out sky or a black border, have no noise to show and do not count
 * unless there are no others.
 *
 * Without flat blocks, as in a picture that is foliage from edge to edge, the estimate is too high, by up to the
 * contrast of the quietest fifth. Noise that grows with brightness is that of the quietest places, mostly the darker
 * ones. */
#ifndef VISTA_SRC_IMAGE_NOISE_H
#define VISTA_SRC_IMAGE_NOISE_H

#include <math.h>

#include "vista/status.h"
#include "vista/types.h"

typedef struct vista_image_noise {
  double sigma; /* standard deviation of a pixel in grey levels, 0 .. 57 */
} vista_image_noise;

/* An image too small for a block has none. VISTA_ERROR_ARGUMENT: no pixels. */
vista_status vista_image_noise_measure(const vista_image *image, vista_image_noise *noise);

/* A threshold on grey levels: noise_sigmas times the noise, and never less than floor_levels. */
static inline double vista_image_noise_threshold(const vista_image_noise *noise, double floor_levels,
                                                 double noise_sigmas) {
  return fmax(floor_levels, noise_sigmas * noise->sigma);
}

#endif
