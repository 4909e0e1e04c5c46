"""Pairs for vista-fly through shared memory, from a program that has the cameras (vista/shared_frames.h)."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vista import native
from vista.errors import InputError
from vista.geometry import Array, Pose


class SharedFrames:
    """A ring of three pairs. It is gone when it is closed; who writes may make it anew at any time."""

    def __init__(self, name: str, width: int, height: int) -> None:
        """Raises InputError for a name or a size that does not do."""
        self._ffi, self._lib = native.load("vista")
        self._ring = self._ffi.new("vista_shared_frames *")
        self._check(name, self._lib.vista_shared_frames_create(self._ring, name.encode(), width, height))

    def put(
        self,
        left: NDArray[np.uint8],
        right: NDArray[np.uint8],
        t_ns: int,
        exposed_ns: int = 0,
        pose: Pose | None = None,
        up_world: Array | None = None,
        begins: bool = False,
    ) -> None:
        """left, right: (height, width), raw; t_ns: counts for motion; exposed_ns: the same moment on
        time.monotonic_ns(), 0: now; pose: world_from_camera of the raw left camera; begins: what came
        before was another flight. Raises InputError for images of another size."""
        ffi = self._ffi
        about = ffi.new("vista_shared_frame *")
        about.t_ns, about.exposed_ns, about.begins = t_ns, exposed_ns, begins
        if pose is not None:
            about.has_pose = 1
            about.pose = (pose.rotation.ravel().tolist(), pose.translation_m.tolist())
        if up_world is not None:
            about.has_up, about.up_world = 1, np.asarray(up_world, float).tolist()
        images = [self._image(image) for image in (left, right)]
        self._check("image", self._lib.vista_shared_frames_put(self._ring, about, images[0][0], images[1][0]))

    def close(self) -> None:
        self._lib.vista_shared_frames_destroy(self._ring)

    def _image(self, image: NDArray[np.uint8]) -> tuple[Any, Any]:
        """Makes the image for C, and what it points to."""
        pixels = self._ffi.from_buffer("uint8_t[]", np.ascontiguousarray(image, np.uint8))
        height, width = image.shape
        return self._ffi.new("vista_image *", (pixels, width, height, width)), pixels

    def _check(self, culprit: str, status: int) -> None:
        native.check(self._ffi, self._lib, status, partial(InputError, culprit))
