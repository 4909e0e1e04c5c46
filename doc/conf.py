"""Configuration of the documentation site: make docs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import clang
from clang.cindex import Config

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "build" / "python")]

from make_pages import write_pages  # noqa: E402

HEADERS = ROOT / "build" / "doc" / "headers"
write_pages(ROOT / "doc" / "generated", HEADERS)
if not Config.loaded:  # the library of the pinned wheel, whatever the system has
    Config.set_library_path(str(Path(clang.__file__).parent / "native"))

project = "VISTA"
version = release = (ROOT / "VERSION").read_text().strip()
copyright = "The VISTA authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "hawkmoth"]
exclude_patterns = ["generated"]
html_theme = "furo"
html_title = f"VISTA {release}"
nitpicky = False

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
# Tables are written on by scripts/make_tables.py; registers.md begins with a heading of the second level.
suppress_warnings = ["myst.header"]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"undoc-members": True}
autodoc_type_aliases = {name: name for name in ("Array", "Image", "Disparity")}

hawkmoth_root = str(HEADERS)
hawkmoth_compiler, hawkmoth_autoconf = None, []  # the headers of the compiler are gcc's; clang is not needed
GCC_HEADERS = subprocess.run(["gcc", "-print-file-name=include"], capture_output=True, text=True, check=True)
hawkmoth_clang = ["-std=c17", f"-I{HEADERS}", f"-I{ROOT}/sw/src", "-isystem", GCC_HEADERS.stdout.strip()]
