"""What many tests of the command line take."""

from __future__ import annotations

from functools import partial

import pytest
from command_line import Vista, call


@pytest.fixture
def run_vista(capsys: pytest.CaptureFixture[str]) -> Vista:
    """Calls `vista ARGUMENTS`: exit status, and what it printed."""
    return partial(call, capsys)
