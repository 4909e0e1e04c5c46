/* The word in which a disparity travels from the engine to the host: signed 16 bit, 1/16 px, negative without one. */
#ifndef VISTA_WORD_H
#define VISTA_WORD_H

#define VISTA_DISPARITY_SCALE 16     /* words a pixel */
#define VISTA_DISPARITY_INVALID (-16) /* the word of a pixel without a disparity */

#endif
