/* Parameters from a configuration file, the same that the command line takes with --config.
 *
 * Of TOML this is the part that `vista config` prints: comments, [section], and name = value with an integer, a decimal
 * number or a string without escapes. All else is refused, with the number of the line. */
#ifndef VISTA_FLY_CONFIG_H
#define VISTA_FLY_CONFIG_H

#include <stddef.h>

#include "problem.h"
#include "vista/parameters.h"

#define CONFIG_MOST_BYTES 262144

/* Sets the parameters that a text names, and checks them all. name: of the file. On a problem they are undefined. */
bool config_parse(const char *name, const char *text, size_t bytes, vista_parameters *parameters, problem *p);

/* The same with the text of a file. */
bool config_read(const char *path, vista_parameters *parameters, problem *p);

#endif
