"""Make the C structs of the host's parameters from sw/parameters.toml (the one place where they are written).

usage: make_parameters.py PARAMETERS.toml HEADER.h SOURCE.c [--check]

--check writes nothing and exits 1 when a file differs from what would be written.
"""

from __future__ import annotations

import argparse
import sys
import tomllib
from pathlib import Path
from typing import Any

Entry = dict[str, Any]
C_TYPE = {"int": "int32_t", "float": "double"}


def entries_of(section: Entry) -> dict[str, Entry]:
    return {name: entry for name, entry in section.items() if isinstance(entry, dict)}


def enum_type(section: str, name: str) -> str:
    return f"vista_{section}_{name}"


def enum_constant(section: str, name: str, choice: str) -> str:
    return f"VISTA_{section}_{name}_{choice}".upper()


def comment(entry: Entry) -> str:
    parts = [entry["doc"]]
    if entry.get("symbol"):
        parts.append(f"Paper: {entry['symbol']}.")
    unit = f" {entry['unit']}" if entry.get("unit") else ""
    if entry["type"] != "choice":
        parts.append(f"{entry['min']} .. {entry['max']}{unit}.")
    return " ".join(parts)


def header_text(schema: dict[str, Entry]) -> str:
    lines = [
        "/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */",
        "#ifndef VISTA_PARAMETERS_H",
        "#define VISTA_PARAMETERS_H",
        "",
        "#include <stdint.h>",
        "",
        '#include "vista/status.h"',
    ]
    for section, content in schema.items():
        lines += ["", f"/* {content['doc']} */"]
        entries = entries_of(content)
        for name, entry in entries.items():
            if entry["type"] == "choice":
                constants = ", ".join(enum_constant(section, name, c) for c in entry["choices"])
                lines += [f"typedef enum {enum_type(section, name)} {{ {constants} }} {enum_type(section, name)};", ""]
        lines.append(f"typedef struct vista_{section}_params {{")
        for name, entry in entries.items():
            c_type = enum_type(section, name) if entry["type"] == "choice" else C_TYPE[entry["type"]]
            lines.append(f"  {c_type} {name}; /* {comment(entry)} */")
        lines.append(f"}} vista_{section}_params;")
    lines += ["", "typedef struct vista_parameters {"]
    lines += [f"  vista_{section}_params {section};" for section in schema]
    lines += [
        "} vista_parameters;",
        "",
        "vista_parameters vista_parameters_default(void);",
        "",
        "/* VISTA_OK, or VISTA_ERROR_RANGE (NaN included) with `culprit` set to \"section.name\"; culprit may be null. */",
        "vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit);",
        "",
        "#endif",
    ]
    return "\n".join(lines) + "\n"


def default_literal(section: str, name: str, entry: Entry) -> str:
    if entry["type"] == "choice":
        return enum_constant(section, name, entry["default"])
    return repr(int(entry["default"]) if entry["type"] == "int" else float(entry["default"]))


def source_text(schema: dict[str, Entry]) -> str:
    lines = [
        "/* Generated from sw/parameters.toml by scripts/make_parameters.py; do not edit. */",
        '#include "vista/parameters.h"',
        "",
        "#include <stdbool.h>",
        "#include <stddef.h>",
        "",
        "vista_parameters vista_parameters_default(void) {",
        "  return (vista_parameters){",
    ]
    for section, content in schema.items():
        for name, entry in entries_of(content).items():
            lines.append(f"      .{section}.{name} = {default_literal(section, name, entry)},")
    lines += [
        "  };",
        "}",
        "",
        "static bool within(double value, double low, double high) { return value >= low && value <= high; }",
        "",
        "vista_status vista_parameters_check(const vista_parameters *parameters, const char **culprit) {",
        "  if (parameters == NULL) return VISTA_ERROR_ARGUMENT;",
        "  const vista_parameters *const p = parameters;",
        "  const char *wrong = NULL;",
    ]
    for section, content in schema.items():
        for name, entry in entries_of(content).items():
            low, high = (0, len(entry["choices"]) - 1) if entry["type"] == "choice" else (entry["min"], entry["max"])
            value = f"(double)p->{section}.{name}" if entry["type"] != "float" else f"p->{section}.{name}"
            prefix = "  " if lines[-1].startswith("  const char") else "  else "
            lines.append(f'{prefix}if (!within({value}, {low}, {high})) wrong = "{section}.{name}";')
    lines += [
        "  if (culprit != NULL) *culprit = wrong;",
        "  return wrong == NULL ? VISTA_OK : VISTA_ERROR_RANGE;",
        "}",
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parameters", type=Path)
    parser.add_argument("header", type=Path)
    parser.add_argument("source", type=Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    schema = tomllib.loads(arguments.parameters.read_text())
    stale = False
    for path, text in ((arguments.header, header_text(schema)), (arguments.source, source_text(schema))):
        if path.exists() and path.read_text() == text:
            continue
        stale = True
        if arguments.check:
            print(f"make_parameters: {path}: differs from {arguments.parameters}; run make generate", file=sys.stderr)
        else:
            path.write_text(text)
    return 1 if arguments.check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
