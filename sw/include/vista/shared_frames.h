/* Pairs from a program that has the cameras to vista-fly, through shared memory of Linux (/dev/shm/NAME).
 *
 *   vista_shared_frames ring;
 *   vista_shared_frames_create(&ring, "vista", 640, 480);
 *   for each pair:
 *     vista_shared_frames_put(&ring, &about, &left, &right);
 *   vista_shared_frames_destroy(&ring);
 *
 * One program writes, any number read; nobody waits for anybody. A frame is lost to a reader when three newer ones came
 * while it was read. Who writes may end, or be killed, and create the ring anew: readers find it by its name.
 *
 * Layout, little-endian: vista_shared_head, then VISTA_SHARED_SLOTS slots of slot_bytes each: vista_shared_frame, then
 * from VISTA_SHARED_PIXELS on height * width bytes of the left image and as many of the right one, raw and grey. Frame
 * number n is in slot n % VISTA_SHARED_SLOTS; its number is 0 while it is written, and `newest` is set last. */
#ifndef VISTA_SHARED_FRAMES_H
#define VISTA_SHARED_FRAMES_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

#define VISTA_SHARED_VERSION 1
#define VISTA_SHARED_SLOTS 3
#define VISTA_SHARED_PIXELS 192 /* where the images begin in a slot */

/* The beginning of the memory. */
typedef struct vista_shared_head {
  char magic[8]; /* "VISTASHM" */
  uint32_t version, width_px, height_px, slot_bytes;
  uint32_t newest; /* number of the newest frame, from 1; 0: none */
  uint32_t reserved[9];
} vista_shared_head;

/* What is known of a pair. */
typedef struct vista_shared_frame {
  uint32_t number;  /* set by vista_shared_frames_put */
  uint32_t has_pose, has_up; /* 1 or 0 */
  uint32_t begins; /* 1: what came before was another flight */
  int64_t t_ns; /* counts for the motion of things; increases from frame to frame */
  int64_t exposed_ns; /* the same moment on CLOCK_MONOTONIC of this machine; 0: now */
  vista_pose pose; /* of the raw left camera in the world */
  double up_world[3]; /* unit vector against gravity */
} vista_shared_frame;

/* A ring that this program writes, in memory of the caller. Its members are the library's own. */
typedef struct vista_shared_frames {
  unsigned char *memory;
  size_t bytes, slot_bytes;
  int32_t width_px, height_px;
  uint32_t number;
  char path[96];
} vista_shared_frames;

/* Makes the ring, in place of one of that name. name: up to 64 letters, digits, dots, minus and underscores.
 * VISTA_ERROR_RANGE: the name; VISTA_ERROR_SIZE: images of less than 16 or more than 8192 px a side;
 * VISTA_ERROR_SHARED: the system gives no shared memory. */
VISTA_API vista_status vista_shared_frames_create(vista_shared_frames *ring, const char *name, int32_t width_px,
                                                  int32_t height_px);

/* Writes a pair. VISTA_ERROR_SIZE: the images have another size than the ring. */
VISTA_API vista_status vista_shared_frames_put(vista_shared_frames *ring, const vista_shared_frame *about,
                                               const vista_image *left, const vista_image *right);

/* Takes the ring away. */
VISTA_API void vista_shared_frames_destroy(vista_shared_frames *ring);

VISTA_END

#endif
