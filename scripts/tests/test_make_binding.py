"""The header reader behind the bindings: what it keeps, what it drops, how it fails."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[1] / "make_binding.py"

HEADER = """
/* a comment with int not_declared(void); inside */
#ifndef GUARD_H
#define GUARD_H
#include <stdint.h>
#define MOST 4 /* items */
#define LOWEST (-16)
#define FLAGS 0x10u
#define TWICE(x) (2 * (x))
#define NAME "text"
typedef struct table { int32_t items[MOST]; } table; // one line
int32_t total(const table *t);
#endif
"""


def run(*arguments: Path | str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, SCRIPT, *arguments], capture_output=True, text=True, check=False)


def test_declarations_and_constants_arrive(tmp_path):
    header, out = tmp_path / "table.h", tmp_path / "made" / "table_abi.py"
    header.write_text(HEADER)
    done = run("table_abi", header, "--out", out)
    assert done.returncode == 0, done.stderr
    spec = importlib.util.spec_from_file_location("table_abi", out)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.ffi.sizeof("table") == 16
    lib = module.ffi.dlopen(None)
    assert (lib.MOST, lib.LOWEST, lib.FLAGS) == (4, -16, 16)


def test_unreadable_header_names_itself_and_leaves_nothing(tmp_path):
    header, out = tmp_path / "broken.h", tmp_path / "broken_abi.py"
    header.write_text("int f(unknown_type x);")
    done = run("broken_abi", header, "--out", out)
    assert done.returncode != 0
    assert "broken.h" in done.stderr and "Traceback" not in done.stderr
    assert not out.exists()


def test_missing_header(tmp_path):
    done = run("none_abi", tmp_path / "none.h", "--out", tmp_path / "none_abi.py")
    assert done.returncode != 0
    assert done.stderr.strip() == f"make_binding: no such header: {tmp_path / 'none.h'}"
