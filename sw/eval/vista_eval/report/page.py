"""The page of results: one template for every suite, a section for each of its parts."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray
from vista import parameters
from vista.report.page import fill_template

from vista_eval.report.table import Table

JPEG_QUALITY = 75


@dataclass(frozen=True)
class Picture:
    caption: str
    jpeg: bytes
    failing: bool = False  # shown with a red frame

    @property
    def uri(self) -> str:
        return "data:image/jpeg;base64," + base64.b64encode(self.jpeg).decode()


@dataclass(frozen=True)
class Section:
    title: str
    tables: Sequence[Table] = ()
    text: str | Markup = ""
    plots: Sequence[str] = ()  # SVG elements
    pictures: Sequence[Picture] = ()
    anchor: str = ""


@dataclass(frozen=True)
class Page:
    title: str
    facts: str
    sections: list[Section]
    definitions: str = ""
    parameters: parameters.Values = field(default_factory=dict)
    wide: bool = False  # a picture takes the whole width

    def render(self) -> str:
        values = vars(self) | {
            "sections": [
                vars(section) | {"plots": [Markup(plot) for plot in section.plots]}
                for section in self.sections
            ]
        }
        return fill_template("results.html.j2", package="vista_eval.report", **values)


def as_jpeg(picture: NDArray[np.uint8], quality: int = JPEG_QUALITY) -> bytes:
    done, jpeg = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert done
    return jpeg.tobytes()
