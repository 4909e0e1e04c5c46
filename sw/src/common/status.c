#include "vista/status.h"

typedef struct entry {
  const char *name;
  const char *text;
} entry;

static const entry table[] = {
    [VISTA_OK] = {"VISTA_OK", "no error"},
    [VISTA_ERROR_ARGUMENT] = {"VISTA_ERROR_ARGUMENT", "a required pointer is null"},
    [VISTA_ERROR_SIZE] = {"VISTA_ERROR_SIZE", "a size is not handled (images: 16 to 8192 px a side), or not as agreed"},
    [VISTA_ERROR_RANGE] = {"VISTA_ERROR_RANGE", "a parameter is out of range"},
    [VISTA_ERROR_MEMORY] = {"VISTA_ERROR_MEMORY", "the memory handed over is too small"},
    [VISTA_ERROR_NUMBER] = {"VISTA_ERROR_NUMBER", "a number is not finite"},
    [VISTA_ERROR_CAPACITY] = {"VISTA_ERROR_CAPACITY", "a fixed-size table is full"},
    [VISTA_ERROR_OVERFLOW] = {"VISTA_ERROR_OVERFLOW", "a sum of capacities overflows"},
    [VISTA_ERROR_ORDER] = {"VISTA_ERROR_ORDER", "timestamps do not increase"},
    [VISTA_ERROR_THREAD] = {"VISTA_ERROR_THREAD", "the system gives no second thread"},
    [VISTA_ERROR_ADDRESS] = {"VISTA_ERROR_ADDRESS", "the host is not an IPv4 address, or the system gives no socket"},
    [VISTA_ERROR_NO_ANSWER] = {"VISTA_ERROR_NO_ANSWER", "the board does not answer"},
    [VISTA_ERROR_BOARD] = {"VISTA_ERROR_BOARD", "the board speaks another protocol, or holds no engine that is known"},
    [VISTA_ERROR_SESSION] = {"VISTA_ERROR_SESSION", "the board was restarted, or another client took it"},
    [VISTA_ERROR_FRAME] = {"VISTA_ERROR_FRAME", "the board did not finish the frame"},
    [VISTA_ERROR_HELD] = {"VISTA_ERROR_HELD", "another client holds the board until it is silent for 3 s"},
    [VISTA_ERROR_SHARED] = {"VISTA_ERROR_SHARED", "the system gives no shared memory"},
};

static const entry unknown = {"VISTA_ERROR_UNKNOWN", "unknown status"};

static const entry *find(vista_status status) {
  const unsigned index = (unsigned)status;
  return index < sizeof table / sizeof table[0] ? &table[index] : &unknown;
}

const char *vista_status_name(vista_status status) { return find(status)->name; }

const char *vista_status_text(vista_status status) { return find(status)->text; }
