"""The place of real imagery for tests: VISTA_SHARED_DATA, else beside the checkout."""

from __future__ import annotations

import os
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
SHARED_DATA = Path(os.environ.get("VISTA_SHARED_DATA") or REPOSITORY.parent / "shared" / "data")
