/* A frame as a line of JSON: a line of obstacles.jsonl, which obstacles.schema.json describes.
 *
 * Numbers are rounded below what the measurements carry, and written as Python writes them. `vista run`, `vista live` and
 * vista-fly all write their lines with it. */
#ifndef VISTA_LINE_H
#define VISTA_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/directions.h"
#include "vista/obstacle.h"
#include "vista/pipeline.h"
#include "vista/status.h"

VISTA_BEGIN

#define VISTA_LINE_VERSION 2    /* "version" of the lines */
#define VISTA_LINE_BYTES 262144 /* enough for the line of any frame without tracks that are not confirmed */
#define VISTA_LINE_REASONS 16

/* What is found wrong with a frame, with what a caller has found besides. */
typedef struct vista_line_health {
  vista_health_state state;
  int32_t reason_count;
  const char *reasons[VISTA_LINE_REASONS]; /* names, such as "no_contrast" */
} vista_line_health;

/* Adds a reason, unless it is there; the state becomes the worse one of both. More than VISTA_LINE_REASONS are dropped. */
VISTA_API void vista_line_health_add(vista_line_health *found, vista_health_state state, const char *reason);

/* Writes the line of a frame of this number, with its line break and a zero behind it. *length: bytes before the zero.
 * directions: null where they are not known. all_tracks: also those that are not confirmed. VISTA_ERROR_MEMORY: they have
 * no room; VISTA_LINE_BYTES are always enough for confirmed ones. */
VISTA_API vista_status vista_line_write(const vista_result *result, const vista_directions *directions,
                                        const vista_line_health *health, int64_t frame, int64_t t_ns, bool all_tracks,
                                        char *text, size_t capacity, size_t *length);

VISTA_END

#endif
