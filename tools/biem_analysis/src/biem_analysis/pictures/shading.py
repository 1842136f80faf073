"""Colours of visible surface points: two lamps, sky light, highlights, contact shadows.

Knows normals and colours; knows no cells.  Colours are linear until `to_screen`.
"""

import numpy as np
from scipy import ndimage

KEY_LIGHT = np.array([-0.45, 0.75, 0.62])    # right, up, toward the eye
FILL_LIGHT = np.array([0.75, -0.10, 0.45])
GAMMA = 2.2


def shade(normal, color):
    """Light reflected to the eye.

    Parameters
    ----------
    normal : array (n, 3), unit outward normals as (right, up, toward the eye)
    color : array (n, 3), linear RGB of the surface

    Returns
    -------
    array (n, 3), linear RGB
    """
    key = KEY_LIGHT / np.linalg.norm(KEY_LIGHT)
    fill = FILL_LIGHT / np.linalg.norm(FILL_LIGHT)
    half = key + np.array([0.0, 0.0, 1.0])
    half /= np.linalg.norm(half)
    diffuse = np.clip(0.25 + 0.75 * (normal @ key), 0.0, 1.0) ** 1.4
    sky = 0.5 + 0.5 * normal[:, 1]
    light = 0.82 * diffuse + 0.16 * np.clip(normal @ fill, 0.0, 1.0) + 0.12 + 0.14 * sky
    facing = np.clip(normal[:, 2], 0.0, 1.0)
    gloss = 0.20 * np.clip(normal @ half, 0.0, 1.0) ** 42
    rim = 0.10 * (1.0 - facing) ** 3 * (0.4 + 0.6 * sky)
    return color * light[:, None] + (gloss + rim)[:, None]


def blur(image, deviation):
    """Gaussian blur of the standard deviation in pixels, as three box averages: its cost does
    not grow with the deviation."""
    width = max(1, int(round(2.0 * deviation)))    # variance of a box: (width^2 - 1)/12
    for _ in range(3):
        image = ndimage.uniform_filter(image, width, mode="nearest")
    return image


def compute_contact_shadow(depth, radius, length):
    """Factor in (0, 1] that darkens what lies behind an edge nearby.

    Method: unsharp masking of the depth buffer, Luft, Colditz & Deussen, ACM Trans. Graph. 25
    (2006) 1206.

    Parameters
    ----------
    depth : array (height, width), infinite where there is nothing
    radius : float, pixels, how far a shadow reaches
    length : float, depth difference of a full shadow
    """
    filled = np.isfinite(depth)
    if not filled.any():
        return np.ones_like(depth)
    far = np.where(filled, depth, depth[filled].max())
    shadow = np.zeros_like(far)
    for scale in (1.0, 0.3):
        blurred = blur(far, scale * radius)
        shadow += 0.5 * np.clip((far - blurred) / length, 0.0, 1.0)
    return np.where(filled, 1.0 - 0.62 * shadow, 1.0)


def find_outlines(depth, jump):
    """Mask (height, width) of pixels at an edge where the depth jumps by more than `jump`."""
    far = np.where(np.isfinite(depth), depth, 1e30)
    return (ndimage.maximum_filter(far, size=3) - far > jump) & np.isfinite(depth)


def to_screen(image, factor):
    """Average blocks of factor x factor pixels of a linear image; give 8-bit sRGB-like values."""
    height, width = (size // factor for size in image.shape[:2])
    blocks = image[:height * factor, :width * factor].reshape(height, factor, width, factor, 3)
    mean = np.clip(blocks.mean(axis=(1, 3)), 0.0, 1.0)
    return np.round(255.0 * mean ** (1.0 / GAMMA)).astype(np.uint8)


def to_linear(color):
    """Linear RGB of a screen colour with components in [0, 1]."""
    return np.asarray(color, dtype=float) ** GAMMA
