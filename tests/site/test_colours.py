# SPDX-License-Identifier: Apache-2.0
"""Contrast as WCAG 2.2 defines it, and colours that differ for every kind of colour vision.

axe-core judges the text of the document; drawings are canvases, which it cannot read.
"""

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from site_pages import Open

Colour = NDArray[np.float64]

TEXTS = ("ink", "quiet", "left", "right", "zero", "drop", "accent")
LINES = ("edge", "object-edge", "both")
GROUNDS = ("background", "raised", "ground", "body")

# Linear RGB as seen without one kind of cone: Machado, Oliveira and Fernandes (2009), severity 1.
VISIONS = {
    "usual": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216],
                   [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413],
                     [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602],
                   [0.004733, 0.691367, 0.303900]],
}  # fmt: skip
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def linear(page: Page, name: str) -> Colour:
    """A colour of the style sheet as linear RGB."""
    text = page.evaluate(
        "name => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim()",
        name,
    )
    if len(text) == 4:  # the build shortens #ffffff
        text = "#" + "".join(2 * digit for digit in text[1:])
    assert len(text) == 7, name
    value = np.array([int(text[k : k + 2], 16) for k in (1, 3, 5)]) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def contrast(one: Colour, other: Colour) -> float:
    """The contrast ratio of WCAG."""
    low, high = sorted(float(colour @ XYZ[1]) for colour in (one, other))
    return (high + 0.05) / (low + 0.05)


def lab(colour: Colour) -> Colour:
    """CIE L*a*b* for the white point D65."""
    ratio = XYZ @ np.clip(colour, 0, 1) / XYZ.sum(axis=1)
    x, y, z = np.where(ratio > (6 / 29) ** 3, np.cbrt(ratio), ratio * (29 / 6) ** 2 / 3 + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_contrast(open_page: Open, scheme: str) -> None:
    page = open_page("#carry?t=2", scheme=scheme)
    for least, names in ((4.5, TEXTS), (3.0, LINES)):
        for name, ground in itertools.product(names, GROUNDS):
            ratio = contrast(linear(page, name), linear(page, ground))
            assert ratio >= least, (name, ground, ratio)
    for name in ("left", "right"):  # the letters of the cases stand on them
        assert contrast(linear(page, name), linear(page, "background")) >= 4.5


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("vision", VISIONS)
def test_every_colour_vision_distinguishes_them(open_page: Open, scheme: str, vision: str) -> None:
    page = open_page("#carry?t=2", scheme=scheme)
    seen = {name: lab(np.array(VISIONS[vision]) @ linear(page, name))
            for name in ("left", "right", "zero", "slides", "ink")}  # fmt: skip
    for one, other in itertools.combinations(seen, 2):
        difference = float(np.linalg.norm(seen[one] - seen[other]))
        assert difference >= 15, (one, other, difference)
