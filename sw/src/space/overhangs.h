/* What has no texture and hangs above ground that is matched.
 *
 * What is not matched is taken to stand on the ground below it (evidence.h). That holds for a plain wall and not for a
 * plain beam, of which the lower edge is seen before ground far behind it. One image does not tell them apart, but the
 * way of the aircraft does: from wherever it is seen, a wall hides the ground behind its foot, and what hangs hides
 * other ground as the aircraft comes nearer. So where an older frame has matched what a wall would have hidden, the
 * surface may hang anywhere. An aircraft that hardly moves sees no more of it, and it still may. */
#ifndef VISTA_OVERHANGS_H
#define VISTA_OVERHANGS_H

#include "perceive/frame_view.h"
#include "space/evidence.h"

/* Marks what hangs in the newest evidence, which is of this frame, by what an older one matched. before: the frame before,
 * which may be the same. */
void vista_overhangs_mark(const vista_frame_view *frame, const vista_evidence *older, const vista_evidence *before,
                          vista_evidence *newest);

#endif
