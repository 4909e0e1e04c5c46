"""Write a cffi out-of-line ABI module from public C headers; users need neither a compiler nor Python.h.

    make_binding.py MODULE HEADER... --out FILE.py

Headers are read in the order of their includes. Comments, includes, conditionals, inline functions and the
macros of vista/api.h go; integer #defines stay as constants.
"""

from __future__ import annotations

import argparse
import contextlib
import re
import sys
import tempfile
from pathlib import Path

import cffi

_COMMENT_OR_TEXT = re.compile(r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'""", re.DOTALL)
_DEFINE = re.compile(r"#\s*define\s+([A-Za-z_]\w*)(?!\()\s+(.+)")
_INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)
_API_MACRO = re.compile(r"\bVISTA_(?:API|BEGIN|END)\b")
_INLINE = re.compile(r"^static inline .*?^\}$", re.DOTALL | re.MULTILINE)
_INTEGER = re.compile(r"\(?\s*([+-]?\s*(?:0[xX][0-9a-fA-F]+|\d+))[uUlL]*\s*\)?")


def strip_comments(text: str) -> str:
    def keep_text(match: re.Match[str]) -> str:
        return " " if match.group().startswith("/") else match.group()

    return _COMMENT_OR_TEXT.sub(keep_text, text)


def declarations(header: str, known: dict[str, str]) -> str:
    """The C declarations of one header as cffi's cdef reads them; `known` gains its integer constants."""
    lines: list[str] = []
    constants: dict[str, str] = {}
    for line in strip_comments(header).replace("\\\n", " ").splitlines():
        if not line.lstrip().startswith("#"):
            lines.append(line)
            continue
        define = _DEFINE.match(line.strip())
        integer = _INTEGER.fullmatch(define.group(2).strip()) if define else None
        if define and integer:
            constants[define.group(1)] = integer.group(1).replace(" ", "")
    known.update(constants)
    body = _INLINE.sub("", _API_MACRO.sub("", "\n".join(lines)))
    for name, value in known.items():  # array sizes must be plain numbers
        body = re.sub(rf"\[\s*{name}\s*\]", f"[{value}]", body)
    defines = "".join(f"#define {name} {value}\n" for name, value in constants.items())
    return defines + "\n".join(line for line in body.splitlines() if line.strip()) + "\n"


def in_order_of_use(headers: list[Path]) -> list[Path]:
    """The same headers, each after those that it includes; the order is otherwise kept."""
    ordered: list[Path] = []

    def visit(header: Path, above: tuple[Path, ...]) -> None:
        if header in ordered:
            return
        if header in above:
            raise SystemExit(f"make_binding: {header}: includes itself")
        for included in _INCLUDE.findall(header.read_text()):
            for other in headers:
                if other.as_posix().endswith("/" + included):
                    visit(other, (*above, header))
        ordered.append(header)

    for header in headers:
        visit(header, ())
    return ordered


def write_binding(headers: list[Path], module: str, out: Path) -> None:
    builder = cffi.FFI()
    builder.set_source(module, None)
    known: dict[str, str] = {}
    for header in in_order_of_use(headers):
        try:
            builder.cdef(declarations(header.read_text(), known))
        except (cffi.CDefError, cffi.FFIError) as error:
            raise SystemExit(f"make_binding: {header}: {error}") from error
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out.parent) as folder:
        written = Path(folder) / out.name
        with contextlib.redirect_stdout(None):  # it reports what it writes
            builder.emit_python_code(str(written))
        written.replace(out)


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("module")
    parser.add_argument("headers", nargs="+", type=Path)
    parser.add_argument("--out", required=True, type=Path)
    options = parser.parse_args(arguments)
    missing = [header for header in options.headers if not header.is_file()]
    if missing:
        raise SystemExit(f"make_binding: no such header: {missing[0]}")
    write_binding(options.headers, options.module, options.out)


if __name__ == "__main__":
    main(sys.argv[1:])
