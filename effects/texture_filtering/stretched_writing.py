"""S01, S02: stretched writing that is readable only at a flat angle, where a pixel's footprint is a strip.

It is drawn with one probe a pixel, and with several along the strip.

The page is the square from -1 to 1 in x and z at y = 0, with its texture's lower edge at z = 1. Along z,
letters are ``STRETCH`` times too high; a view from asin(1 / STRETCH) above makes them right again.

Source: Schilling 1997, section 2, figures 1 and 2 (another text); pass sequence A-S02 of the catalogue.
"""

from dataclasses import replace

import numpy as np
from PIL import ImageFont

from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.geometry.samples import rays, sample_places
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import orthographic_view, perspective_view
from fixedpipe.effects.passes.draws import FIRST_PASS, NEAREST, REPLACE, draw, unit
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.textures.images import texture_2d
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (Technique("S01", "isotropic mip-mapping, one probe a pixel", "2"),)

STRETCH = 8
LINES = (
    "WHO LOOKS AT THIS PAGE FROM ABOVE MAY SEE",
    "BARS AND SLABS OF INK AND NOT A WORD OF IT",
    "WHO LOOKS ALONG IT FROM ITS LOWER EDGE CAN",
    "READ ALL OF IT AS WELL AS ANY PAGE AROUND",
)
PAPER, INK = (0.94, 0.90, 0.80), (0.09, 0.10, 0.22)
PAGE = "page"


def page_edge(size):
    """Texels of the page's edge for panels of ``size`` pixels: as many, a power of two from 256 on."""
    return max(256, 1 << (size - 1).bit_length())


def letters(lines):
    """Lines of text in Pillow's bitmap font: bool [rows, 6 characters] each, of the rows that have ink in any
    of them, bottom row first.
    """
    font = ImageFont.load_default_imagefont()
    masks = [font.getmask(line) for line in lines]
    ink = [np.array(m, np.uint8).reshape(m.size[1], m.size[0])[::-1] > 0 for m in masks]
    used = np.nonzero(np.any([one.any(axis=1) for one in ink], axis=0))[0]
    return [one[used[0] : used[-1] + 1] for one in ink]


def writing(edge, lines=LINES, stretch=STRETCH):
    """The page: float64 [edge, edge, 3], bottom row first.

    edge     texels, 256 or more: a pixel of the font is edge/256 texels wide
    stretch  how many times as high as wide it is

    Raises ValueError if the lines do not fit.
    """
    scale = max(1, edge // 256)
    printed = [ink.repeat(stretch * scale, axis=0).repeat(scale, axis=1) for ink in letters(lines)]
    high, wide = sum(len(p) for p in printed), max(p.shape[1] for p in printed)
    if high > edge or wide > edge:
        raise ValueError(f"The lines take {wide}x{high} texels and the page has {edge}x{edge}; write less.")
    gap, page = (edge - high) // (len(printed) + 1), np.zeros((edge, edge), bool)
    top = edge - gap
    for ink in printed:
        left = (edge - ink.shape[1]) // 2
        page[top - len(ink) : top, left : left + ink.shape[1]] = ink
        top -= len(ink) + gap
    return np.where(page[..., None], INK, PAPER)


def stripes(edge, period=4):
    """A page of smooth lines along its length, ``period`` texels from one to the next: float64 [edge, edge,
    3]. Triangles and no sines: the same bits everywhere.
    """
    phase = (np.arange(edge) + 0.5) / period % 1.0
    wave = np.abs(2.0 * phase - 1.0)
    return np.broadcast_to(wave[None, :, None], (edge, edge, 3)).copy()


def load(page, profile):
    """The command that loads a page and its mip-maps."""
    texels = page if profile.arithmetic.exact else np.floor(255.0 * page + 0.5).astype(np.uint8)
    return TexImage(label="load the page", texture=PAGE, image=texture_2d(texels, mipmaps=True))


def sampler(**settings):
    """Trilinear; ``settings``: ``max_probes`` or ``max_anisotropy``."""
    filters = TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR
    return Sampler(*filters, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE, **settings)


def page_pass(label, view, read):
    """The loaded page in a view, as a sampler reads it."""
    corners = np.array([(-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, -1.0)])
    mesh = Mesh(
        positions=corners,
        indices=np.array([0, 1, 2, 0, 2, 3]),
        texture_coordinates=(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),),
    )
    return draw(label, mesh, view, None, (unit(PAGE, read, environment=REPLACE),), depth_test=FIRST_PASS)


def footprints(view, edge):
    """r_1 and r_2 of every pixel whose middle shows the page, in texels: float64 [k, 2] each.

    ``edge``: the texels of the page's edge.
    """
    ray, eye = rays(view), np.array(view.eye)
    x, y = np.meshgrid(np.arange(view.panel.width) + 0.5, np.arange(view.panel.height) + 0.5)
    to = (ray[0] + x[..., None] * ray[1]) + y[..., None] * ray[2]
    down = np.where(to[..., 1] < 0.0, to[..., 1], -1.0)
    along = -eye[1] / down
    point = eye + along[..., None] * to
    met = (to[..., 1] < 0.0) & (np.abs(point[..., 0]) <= 1.0) & (np.abs(point[..., 2]) <= 1.0)
    out = []
    for step in ray[1:]:
        change = (along[..., None] * (step - (step[1] / down)[..., None] * to))[met]
        out.append(0.5 * edge * np.stack([change[:, 0], -change[:, 2]], axis=-1))
    return tuple(out)


@kernel("void(f8[:,::1],f8[::1],f8[:,:,::1],f8[:,:,::1],i8,f8[::1],f8[:,:,::1])")
def _sampled(ray, eye, page, places, side, background, out):
    """Means of ``side`` squared samples of a page on y = 0 between -1 and 1."""
    edge = len(page)
    mask = len(places) - 1
    for y in range(out.shape[0]):
        for x in range(out.shape[1]):
            for number in range(side * side):
                px, py = x * side + number % side, y * side + number // side
                wx = x + (number % side + places[py & mask, px & mask, 0]) / side
                wy = y + (number // side + places[py & mask, px & mask, 1]) / side
                down = ray[0, 1] + wx * ray[1, 1] + wy * ray[2, 1]
                along = -eye[1] / down if down < 0.0 else np.inf
                s = 0.5 * (1.0 + (eye[0] + along * (ray[0, 0] + wx * ray[1, 0] + wy * ray[2, 0])))
                t = 0.5 * (1.0 - (eye[2] + along * (ray[0, 2] + wx * ray[1, 2] + wy * ray[2, 2])))
                if not (0.0 <= s <= 1.0 and 0.0 <= t <= 1.0):
                    for c in range(3):
                        out[y, x, c] += background[c]
                    continue
                at_s = min(max(s * edge - 0.5, 0.0), edge - 1.0)
                at_t = min(max(t * edge - 0.5, 0.0), edge - 1.0)
                column, row = min(int(at_s), edge - 2), min(int(at_t), edge - 2)
                u, v = at_s - column, at_t - row
                for c in range(3):
                    lower = page[row, column, c] + u * (page[row, column + 1, c] - page[row, column, c])
                    upper = page[row + 1, column, c]
                    upper += u * (page[row + 1, column + 1, c] - page[row + 1, column, c])
                    out[y, x, c] += lower + v * (upper - lower)
            for c in range(3):
                out[y, x, c] /= side * side


@computed_once
def supersampled(view, page, background, side=16):
    """The reference by ``side`` squared samples a pixel of a page [edge, edge, 3], bilinear: float64 [height,
    width, 3], bottom row first; ``background`` where there is none. The page has two texels or more an edge.
    """
    out = np.zeros((view.panel.height, view.panel.width, 3))
    page, places = np.ascontiguousarray(page, np.float64), sample_places(side)
    _sampled(rays(view), np.array(view.eye, np.float64), page, places, side, np.array(background), out)
    return out


def found_stretch(page, lines=LINES, most=16):
    """The stretch of a page [edge, edge, 3], from 1 to ``most``.

    It is the factor of compression with which its first line's ink resembles the letters most.
    """
    scale = max(1, len(page) // 256)
    ink = (page - np.array(PAPER)).sum(axis=-1) / (np.array(INK) - np.array(PAPER)).sum()
    first = letters(lines)[0].astype(np.float64)
    top, left = np.nonzero(ink.max(axis=1) > 0.5)[0][-1] + 1, (len(page) - first.shape[1] * scale) // 2
    alike = []
    for stretch in range(1, most + 1):
        high = len(first) * scale * stretch
        if high > top:
            break
        seen = ink[top - high : top, left : left + first.shape[1] * scale]
        seen = seen.reshape(len(first), scale * stretch, first.shape[1], scale).mean(axis=(1, 3))
        alike.append(correlation(seen, first))
    return 1 + int(np.argmax(alike))


def correlation(image, truth):
    """The correlation of two pictures' deviations from their means, from -1 to 1."""
    a, b = image - image.mean(), truth - truth.mean()
    return float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))


def within_letters(strip):
    """A strip [height, width, 3] minus its mean along the rows over a letter's width.

    The result distinguishes letters. Any blur keeps lines and the spaces between words.
    """
    width = max(2, strip.shape[1] * 6 // 256 // 2 * 2)
    padded = np.pad(strip, ((0, 0), (width // 2, width // 2), (0, 0)), mode="edge")
    total = np.cumsum(np.pad(padded, ((0, 0), (1, 0), (0, 0))), axis=1)
    return strip - ((total[:, width:] - total[:, :-width]) / width)[:, : strip.shape[1]]


def from_above(panel):
    """The page from straight above, filling the panel."""
    return perspective_view(panel, (0.0, 8.0, 1e-6), field_of_view=2.0 * 7.125)


def flat_view(panel, angle, distance=6.0):
    """The page's middle in the panel, ``angle`` degrees above it, as wide as the panel is."""
    radians = np.radians(angle)
    eye = (0.0, distance * float(sine(radians)), distance * float(cosine(radians)))
    half_height = 1.18 * panel.height / panel.width
    field = 2.0 * np.degrees(np.arctan2(half_height, distance))
    return perspective_view(panel, eye, field_of_view=float(field))


def strip_of(picture, panel, profile):
    """Commands that show a picture [height, width, 3] of a panel's size as a texture, a texel a pixel."""
    rows, columns = (1 << (n - 1).bit_length() for n in picture.shape[:2])
    texels = np.zeros((rows, columns, 3))
    texels[: len(picture), : picture.shape[1]] = picture
    view = orthographic_view(panel)
    surface = plane(1, 1, panel.width / panel.height).with_repeats(
        picture.shape[1] / columns, len(picture) / rows
    )
    units = (unit("samples", NEAREST, environment=REPLACE),)
    return (
        replace(load(texels, profile), label="load 256 samples a pixel", texture="samples"),
        draw("256 samples a pixel", surface.mesh(), view, None, units, depth_test=FIRST_PASS),
    )
