/* Errors are values: every libvista function that can fail returns one of these. */
#ifndef VISTA_STATUS_H
#define VISTA_STATUS_H

#include "vista/api.h"

VISTA_BEGIN

/* The result of a function that can fail. */
typedef enum vista_status {
  VISTA_OK = 0,
  VISTA_ERROR_ARGUMENT, /* a required pointer is null */
  VISTA_ERROR_SIZE,     /* an image or array has a size other than the one agreed on */
  VISTA_ERROR_RANGE,    /* a parameter lies outside its stated range */
  VISTA_ERROR_MEMORY,   /* the memory that the caller handed over is too small */
  VISTA_ERROR_NUMBER,   /* a NaN or an infinity where a finite number is required */
  VISTA_ERROR_CAPACITY, /* more items than the fixed capacity of a table */
  VISTA_ERROR_OVERFLOW, /* sums of capacities exceed their integer type */
  VISTA_ERROR_ORDER,    /* timestamps that do not increase */
  VISTA_ERROR_THREAD,   /* the system gives no second thread */
  VISTA_ERROR_ADDRESS,  /* a host is no IPv4 address, or the system gives no socket */
  VISTA_ERROR_NO_ANSWER, /* a board is silent */
  VISTA_ERROR_BOARD,    /* a board speaks another protocol, or holds no engine that is known */
  VISTA_ERROR_SESSION,  /* a board was restarted, or another client took it */
  VISTA_ERROR_FRAME,    /* a board did not finish a frame */
  VISTA_ERROR_HELD,     /* another client holds a board */
  VISTA_ERROR_SHARED    /* the system gives no shared memory */
} vista_status;

/* The name of a status, such as "VISTA_ERROR_SIZE"; never null. */
VISTA_API const char *vista_status_name(vista_status status);

/* A status as one line of text; never null. */
VISTA_API const char *vista_status_text(vista_status status);

VISTA_END

#endif
