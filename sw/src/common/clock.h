/* How long something takes, internal to libvista: a clock that nobody sets. */
#ifndef VISTA_SRC_CLOCK_H
#define VISTA_SRC_CLOCK_H

double vista_clock_ms(void);

#endif
