"""Configuration of the documentation site: make docs."""

from __future__ import annotations

import sys
from pathlib import Path

from clang.cindex import Config

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "build" / "python")]

from make_pages import write_pages  # noqa: E402

write_pages(ROOT / "doc" / "generated")
if not Config.loaded:  # the library of the pinned wheel, whatever the system has
    import clang

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

hawkmoth_root = str(ROOT)
hawkmoth_clang = ["-std=c17", f"-I{ROOT}/sw/include", f"-I{ROOT}/sw/src", f"-I{ROOT}/model/c/include"]
