"""VISTA: stereo obstacle detection for aircraft."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vista.engine import StereoEngine

    __version__: str

__all__ = ["StereoEngine", "__version__"]


def __getattr__(name: str) -> Any:
    """Loads the engine on first use, so that readers and drawing work without the native libraries."""
    if name == "__version__":
        from vista.version import version

        return version()
    if name == "StereoEngine":
        from vista.engine import StereoEngine

        return StereoEngine
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
