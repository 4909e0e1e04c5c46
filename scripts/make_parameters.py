"""Make the C structs of the host's parameters, and the table of them, from sw/parameters.toml.

usage: make_parameters.py PARAMETERS.toml HEADER.h TABLE.h [--check]

--check writes nothing and exits 1 when a file differs from what would be written.
"""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from pathlib import Path
from typing import Any

Entry = dict[str, Any]
C_TYPE = {"int": "int32_t", "float": "double"}
C_BYTES = {"int": 4, "choice": 4, "float": 8}
SECTION_BYTES = 256  # of each section's struct: room for parameters that are still to come
GENERATED = "/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */"

HEADER = """{generated}
#ifndef VISTA_PARAMETERS_H
#define VISTA_PARAMETERS_H

#include <stddef.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/status.h"

VISTA_BEGIN
{structs}
/* All parameters. vista_parameters_default makes the struct; change its members afterwards. A newer library
 * keeps its new parameters behind those of this header and in the reserved parts, and fills them in there. */
typedef struct vista_parameters {{
  size_t struct_bytes; /* size of this struct in the caller's header */
{sections}
}} vista_parameters;

/* Writes the defaults into a struct of this size. VISTA_ERROR_SIZE: it is no size of this struct. */
VISTA_API vista_status vista_parameters_init(vista_parameters *parameters, size_t bytes);

/* Returns the default of every parameter. */
static inline vista_parameters vista_parameters_default(void) {{
  vista_parameters parameters;
  (void)vista_parameters_init(&parameters, sizeof parameters);
  return parameters;
}}

/* Checks every parameter against its range. VISTA_ERROR_SIZE: the struct was not made by
 * vista_parameters_default. VISTA_ERROR_RANGE: a parameter is out of its range or not a number; `culprit`,
 * which may be null, is then set to its "section.name". */
VISTA_API vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit);

/* Sets the parameter called "section.name"; a choice is set by its number. VISTA_ERROR_RANGE: there is no
 * such parameter, or no parameter can have this value. vista_parameters_check judges its own range. */
VISTA_API vista_status vista_parameters_set(vista_parameters *parameters, const char *name, double value);

/* Sets a choice by its name. VISTA_ERROR_RANGE: there is no such parameter or no such choice. */
VISTA_API vista_status vista_parameters_set_choice(vista_parameters *parameters, const char *name,
                                                   const char *choice);

/* Reads the parameter called "section.name"; a choice is read as its number. */
VISTA_API vista_status vista_parameters_get(const vista_parameters *parameters, const char *name,
                                            double *value);

/* The type of a parameter. */
typedef enum vista_parameter_type {{
  VISTA_PARAMETER_INT,
  VISTA_PARAMETER_FLOAT,
  VISTA_PARAMETER_CHOICE
}} vista_parameter_type;

/* The description of one parameter. Its texts are never null. */
typedef struct vista_parameter {{
  const char *name; /* "section.name" */
  const char *unit, *doc;
  vista_parameter_type type;
  double default_value, min, max; /* for a choice: numbers */
  const char *at_most;            /* another parameter that it must not exceed, or "" */
  int32_t choice_count;
  const char *const *choices; /* choice_count names */
}} vista_parameter;

/* The number of parameters. */
VISTA_API int32_t vista_parameter_count(void);

/* The description of a parameter by its index, in the order of the struct; null outside 0 .. count - 1. */
VISTA_API const vista_parameter *vista_parameter_info(int32_t index);

VISTA_END

#endif
"""

TABLE = """{generated}
#ifndef VISTA_SRC_PARAMETERS_TABLE_H
#define VISTA_SRC_PARAMETERS_TABLE_H

#include <stddef.h>

#include "vista/parameters.h"

{choices}

static const struct {{
  vista_parameter info;
  size_t offset; /* in vista_parameters */
}} parameter_table[] = {{
{rows}
}};

{sizes}

#endif
"""


def entries_of(section: Entry) -> dict[str, Entry]:
    return {name: entry for name, entry in section.items() if isinstance(entry, dict)}


def comment(entry: Entry) -> str:
    parts = [entry["doc"]]
    if entry.get("symbol"):
        parts.append(f"Paper: {entry['symbol']}.")
    unit = f" {entry['unit']}" if entry.get("unit") else ""
    if entry["type"] != "choice":
        parts.append(f"{entry['min']} .. {entry['max']}{unit}.")
    if "at_most" in entry:
        parts.append(f"At most {entry['at_most']}.")
    return " ".join(parts)


def section_struct(section: str, content: Entry) -> str:
    lines = []
    used = 0
    fields = []
    for name, entry in entries_of(content).items():
        c_type = C_TYPE.get(entry["type"], f"vista_{section}_{name}")
        if entry["type"] == "choice":
            constants = ", ".join(f"VISTA_{section}_{name}_{choice}".upper() for choice in entry["choices"])
            lines += ["", f"/* {entry['doc']} */", f"typedef enum {c_type} {{ {constants} }} {c_type};"]
        fields.append(f"  {c_type} {name}; /* {comment(entry)} */")
        size = C_BYTES[entry["type"]]
        used = -(-used // size) * size + size
    reserved = f"  unsigned char reserved[{SECTION_BYTES - used}];"
    lines += ["", f"/* {content['doc']} */"]
    lines += [f"typedef struct vista_{section}_params {{", *fields, reserved, f"}} vista_{section}_params;"]
    return "\n".join(lines) + "\n"


def header_text(schema: dict[str, Entry]) -> str:
    structs = "".join(section_struct(section, content) for section, content in schema.items())
    sections = "\n".join(f"  vista_{section}_params {section};" for section in schema)
    return HEADER.format(generated=GENERATED, structs=structs, sections=sections)


def table_row(section: str, name: str, entry: Entry) -> str:
    choices = entry.get("choices", [])
    default = choices.index(entry["default"]) if choices else entry["default"]
    low, high = (0, len(choices) - 1) if choices else (entry["min"], entry["max"])
    at_most = f"{section}.{entry['at_most']}" if "at_most" in entry else ""
    texts = ", ".join(json.dumps(text) for text in (f"{section}.{name}", entry.get("unit", ""), entry["doc"]))
    names = f"{section}_{name}_choices" if choices else "NULL"
    info = (
        f"{texts}, VISTA_PARAMETER_{entry['type'].upper()}, {default}, {low}, {high}, "
        f'"{at_most}", {len(choices)}, {names}'
    )
    return f"    {{{{{info}}}, offsetof(vista_parameters, {section}.{name})}},"


def table_text(schema: dict[str, Entry]) -> str:
    all_entries = [(s, name, entry) for s in schema for name, entry in entries_of(schema[s]).items()]
    choices = "\n".join(
        f"static const char *const {section}_{name}_choices[] = "
        f"{{{', '.join(json.dumps(choice) for choice in entry['choices'])}}};"
        for section, name, entry in all_entries
        if entry["type"] == "choice"
    )
    rows = "\n".join(table_row(*entry) for entry in all_entries)
    sizes = "\n".join(
        f'_Static_assert(sizeof(vista_{section}_params) == {SECTION_BYTES}, "{section} may not grow");'
        for section in schema
    )
    return TABLE.format(generated=GENERATED, choices=choices, rows=rows, sizes=sizes)


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parameters", type=Path)
    parser.add_argument("header", type=Path)
    parser.add_argument("table", type=Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    schema = tomllib.loads(arguments.parameters.read_text())
    stale = False
    for path, text in ((arguments.header, header_text(schema)), (arguments.table, table_text(schema))):
        if path.exists() and path.read_text() == text:
            continue
        stale = True
        if arguments.check:
            print(
                f"make_parameters: {path}: differs from {arguments.parameters}; run make generate",
                file=sys.stderr,
            )
        else:
            path.write_text(text)
    return 1 if arguments.check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
