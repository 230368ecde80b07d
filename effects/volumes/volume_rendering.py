"""H39: iso-surfaces of a volume by slices of a 3D texture, lit by Phong's model, with alpha-coded shadows.

The 3D texture holds a unit normal n as n/2 + 1/2 in RGB and the density in alpha. n points to where the
density falls. It is the negative gradient by central differences of the bytes, normalized at every voxel that
has a gradient. Between voxels the filter shortens it. No machine here restores its length, so creases are too
dark. The passes:

P0  Shadows only. From the light: slices with the alpha test GEQUAL iso and DF LESS, no colours; the slices
    again with DF EQUAL and a 1D ramp of the light's depth instead of the volume. Their alpha becomes the map
    TA (H36).
P1  From the camera: slices through the volume, parallel to the image plane, in any order; alpha test GEQUAL
    iso, DF LESS, no blending. Of all slices beyond the iso-surface the nearest stays: RGB is n there.
P2  Light: the picture is copied onto itself through a colour matrix whose row is l, which gives n.l, and a
    table, (.)+ times the colour. A second copy makes the highlight; its table is the power of n.h.

``imaging``, for machines with the imaging subset and one texture unit:

- P1 draws into an auxiliary buffer, because the second copy needs the normals that the first would overwrite,
  and destination alpha has another use. Copies go from there to the window's buffer, only where P1 left its
  mark in the stencil buffer. One copy gives the light that does not depend on the lamp: ambient light, and a
  weak light from the eye, so that shadows keep their shapes.
- n.l below zero is lost when the colour matrix's results are clamped. On an Octane that happens after the
  matrix, elsewhere in the table. That is (.)+, so nothing is biased (P15 does no harm here).
- Shadows (H38): slices with DF EQUAL write the ramp to destination alpha, and slices with TA are subtracted.
  A copy multiplies alpha by 2^n, and light is added with ONE_MINUS_DST_ALPHA.

``combiners``, for register combiners and two units, shades while it draws slices. P1 has the light that does
not depend on the lamp. Slices with ramp and TA follow (H37); the alpha test compares their difference with 0,
and the stencil buffer marks the fragments. Slices with DF EQUAL at the marks then add n.l and (n.h)^N.

One light vector and one halfway vector serve the whole picture. The light is directional, and the viewer
counts as infinitely far, though slices may be in perspective. Slices lie only in bricks of the volume where
the surface may be visible.

Source: Heidrich 2001, section 2.1 and figure 7, which names Westermann and Ertl 1998 for the light; pass
sequences A-H36 to A-H39 of the catalogue.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.effects.geometry.views import Panel, View
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    NOTHING,
    ONE,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    ZERO,
    both,
    dot,
    expand,
    final,
    product,
    program,
    scaled,
    shown,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import ADD, MARK, MARKED, REPLACE, SUBTRACT, copy_of_panel
from fixedpipe.effects.passes.encoding import colors_of, vector_texels
from fixedpipe.effects.scenes.objects_and_lamps import Lamp
from fixedpipe.effects.shadows.alpha_coded_shadows import (
    ADD_WHERE_ALPHA_IS_ZERO,
    EQUAL_ZERO,
    MAP,
    ONLY_ALPHA,
    ONLY_RGB,
    Coding,
    clear_window,
    difference_combiners,
    map_unit,
    scale_alpha,
)
from fixedpipe.effects.shadows.lit_scene import NO_COLOR
from fixedpipe.effects.technique import Technique
from fixedpipe.effects.volumes.slices import Slices, Volume
from fixedpipe.pipeline.commands import Clear, CopyTexImage, Saturate, TexImage
from fixedpipe.pipeline.enums import ColorBuffer, TextureTarget
from fixedpipe.pipeline.pixel_transfer import PixelTransfer
from fixedpipe.pipeline.state import (
    ColorTable,
    PassState,
)

TECHNIQUES = (
    Technique("H39", "a volume's surface by slices of a 3D texture, with alpha-coded shadows", "2.1"),
)

# Source: catalogue, A-H39.
EXPONENT = 30
# A mask shows as lit what gets this much of the lamp's light, n.l, or more: below, bytes say little.
LEAST = 1.0 / 128.0
# Assumed: of a colour table, entries enough for every byte of n.l and the exponent's steepest place.
TABLE_ENTRIES = 4096

_NORMALS = ColorBuffer.AUX0


# ----------------------------------------------------------------------------------- alpha-coded shadows


def light_map(volume, lamp, panel, count, profile, coding, combiners=None, alpha=None):
    """P0: the map of ``alpha_coded_shadows``, as large as a square ``panel`` of the window, of depths that
    are the coding's bias farther.

    ``combiners``, ``alpha``: programs that give a texel, and its alpha alone; None where texture environments
    do.
    """
    slices = Slices(volume, lamp.view(panel), count)
    ramp = coding.ramp_unit(lamp, slices.view, coding.bias, environment=REPLACE)
    return (
        coding.ramp(profile),
        Clear(label="clear: alpha one is far", color=(0.0, 0.0, 0.0, 1.0), depth=1.0, scissor=panel.scissor),
        slices.solid("slices seen from the light", combiners, color_mask=NO_COLOR),
        slices.again("the same: depth from the light to alpha", (ramp,), alpha),
        CopyTexImage(
            label="copy it as the map",
            texture=MAP,
            internal_format=coding.internal_format(profile),
            x=panel.x,
            y=panel.y,
            width=panel.width,
            height=panel.height,
        ),
    )


def _shadow_alpha(slices, lamp, profile, coding):
    """H38: destination alpha one in shadow, zero in light, where P1 left a surface."""
    view = slices.view
    ramp = coding.ramp_unit(lamp, view, environment=REPLACE)
    projected = map_unit(lamp, view, environment=REPLACE)
    return (
        slices.again("alpha = depth from the light", (ramp,), color_mask=ONLY_ALPHA),
        slices.again("minus the map", (projected,), blending=SUBTRACT, color_mask=ONLY_ALPHA),
        Saturate(label="alpha in [0, 1]", scissor=view.panel.scissor),
        scale_alpha(view.panel, profile.framebuffers.color_bits[0]),
        Saturate(label="alpha 0 or 1", scissor=view.panel.scissor),
    )


# --------------------------------------------------------------------------------- Phong's model of a picture


@dataclass(frozen=True)
class Shading:
    """Phong's model, RGB from 0 to 1.

    color     of the surface, by which ambient and diffuse light are multiplied
    ambient   light from everywhere
    fill      a weak light from the eye, whose shadows are hidden from the eye; it and ambient light reach
              every place
    diffuse, specular   the lamp's
    exponent  a whole number
    mask      True: black, and white where the lamp's light arrives
    """

    color: tuple[float, float, float] = (0.80, 0.82, 0.86)
    ambient: float = 0.12
    fill: float = 0.16
    diffuse: float = 0.72
    specular: float = 0.45
    exponent: int = EXPONENT
    mask: bool = False

    def __post_init__(self):
        checked_rgb(self.color, "The surface's colour")
        if not 1 <= self.exponent <= 127:
            raise ValueError(f"The exponent is {self.exponent}; give a whole number from 1 to 127.")

    def times(self, light):
        """The surface's colour times one of the lights."""
        return tuple(light * c for c in self.color)


@dataclass(frozen=True, eq=False)
class Picture:
    """What is drawn, and from where.

    volume      the Volume
    view        the camera's View; a lamp and a viewer as if infinitely far light it
    lamp        an infinite ``Lamp``
    slices      how many, in both views
    shading     the Shading
    map_panel   a square Panel of the window in which the shadow map is drawn and which it overwrites. It has
                as many pixels as the map has texels, a power of two. None: no shadows
    coding      of the map's depths
    background  RGB
    """

    volume: Volume
    view: View
    lamp: Lamp
    slices: int = 256
    shading: Shading = Shading()
    map_panel: Panel | None = None
    coding: Coding = field(default_factory=Coding)
    background: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self):
        if not self.lamp.infinite:
            raise ValueError(
                "The lamp is a point; one light vector serves the whole picture, so give an infinite lamp."
            )
        if self.slices < 1:
            raise ValueError(f"{self.slices} slices show nothing; give one or more.")

    @property
    def light(self):
        """L, three floats."""
        return tuple(unit_vector(self.lamp.direction, "The direction to the lamp").tolist())

    @property
    def eye(self):
        """The direction to the eye, against the view."""
        return tuple(self.view.modelview[2][:3])

    @property
    def half(self):
        """H, halfway between both."""
        return tuple(normalize(np.array(self.light) + np.array(self.eye)).tolist())

    def load(self, zero):
        """The command that stores the volume, normals about ``zero``."""
        return TexImage(
            label=f"load {self.volume.name}: normals, densities",
            texture=self.volume.name,
            image=self.volume.texture(zero),
            target=TextureTarget.TEXTURE_3D,
        )


# ------------------------------------------------------------------------------------------ imaging subset


def power(base, exponent):
    """``base`` to a whole power, by products in a fixed order."""
    out, square = np.ones_like(base), base
    while exponent:
        if exponent & 1:
            out = out * square
        square, exponent = square * square, exponent >> 1
    return out


@lru_cache(maxsize=16)
def _powers_of(count, color, constant, exponent):
    """Color times the power of an index in [0, 1], plus a constant."""
    value = power(np.arange(count) / (count - 1.0), exponent)
    columns = [(c * value + a).tolist() for c, a in zip((*color, 0.0), (*constant, 0.0), strict=True)]
    return ColorTable(tuple(zip(*columns, strict=True)))


@lru_cache(maxsize=4)
def _step(count):
    """Zero, and one from ``LEAST`` on."""
    value = (np.arange(count) >= LEAST * (count - 1.0)).astype(np.float64).tolist()
    return ColorTable(tuple((v, v, v, v) for v in value))


def _entries(profile):
    return (
        profile.pixels.max_color_table_size
        if profile.arithmetic.exact
        else min(profile.pixels.max_color_table_size, TABLE_ENTRIES)
    )


def _through(vector, table):
    """Pixel transfer of stored normals: n.v by the colour matrix, then a table of (n.v)+."""
    row = (*(2.0 * c for c in vector), 0.0)
    less = -((vector[0] + vector[1]) + vector[2])
    return PixelTransfer(
        color_matrix=(row,) * 4, post_color_matrix_bias=(less,) * 4, post_color_matrix_color_table=table
    )


def _copy(label, view, transfer, **settings):
    """Marked pixels of a panel, from the buffer of normals to the window's."""
    state = PassState(scissor=view.panel.scissor, stencil_test=MARKED, color_mask=ONLY_RGB, **settings)
    return copy_of_panel(label, view.panel, state, transfer, read_buffer=_NORMALS)


def imaging(picture, profile, load=True):
    """H39 by the imaging subset: a ``Picture``'s commands.

    ``profile``: with colour matrix, colour tables, 3D textures and an auxiliary buffer, for shadows
    FUNC_REVERSE_SUBTRACT too. ``load``: False where the volume is loaded already.
    """
    view, shading, count = picture.view, picture.shading, _entries(profile)
    slices = Slices(picture.volume, view, picture.slices)
    added = {"blending": ADD_WHERE_ALPHA_IS_ZERO}
    store = difference = ()
    if picture.map_panel is not None:
        store = light_map(
            picture.volume, picture.lamp, picture.map_panel, picture.slices, profile, picture.coding
        )
        difference = _shadow_alpha(slices, picture.lamp, profile, picture.coding)
    if shading.mask:
        light = (
            _copy("black", view, PixelTransfer(scale=(0.0,) * 4)),
            _copy("white where n.l is positive", view, _through(picture.light, _step(count)), **added),
        )
    else:
        black, gloss = (0.0, 0.0, 0.0), (shading.specular,) * 3
        fill = _powers_of(count, shading.times(shading.fill), shading.times(shading.ambient), 1)
        diffuse = _powers_of(count, shading.times(shading.diffuse), black, 1)
        specular = _powers_of(count, gloss, black, shading.exponent)
        light = (
            _copy("light that is not the lamp's", view, _through(picture.eye, fill)),
            _copy("plus colour times (n.l)+", view, _through(picture.light, diffuse), **added),
            _copy(f"plus ((n.h)+)^{shading.exponent}", view, _through(picture.half, specular), **added),
        )
    return (
        *((picture.load(127.5),) if load else ()),
        *store,
        clear_window(view, checked_rgb(picture.background)),
        slices.solid("slices: normals of the iso-surface", stencil_test=MARK, draw_buffer=_NORMALS),
        *difference,
        *light,
    )


# ------------------------------------------------------------------------------------- register combiners


def _encoded(vector, profile):
    return (*colors_of(vector_texels(vector, profile)).tolist(), 0.0)


def _dots(profile, first, second):
    """A general combiner: n.first to spare 0, n.second to spare 1."""
    n = expand(TEXTURE0)
    return stage(
        both(dot(n, expand(CONSTANT0), to=SPARE0), dot(n, expand(CONSTANT1), to=SPARE1)),
        constant0=_encoded(first, profile),
        constant1=_encoded(second, profile),
    )


def _raised(exponent):
    """General combiners that raise spare 1 to a whole power: each squares it, and multiplies texture 1 by
    what was squared where the exponent has that bit. The last leaves the product in spare 1.
    """
    stages, power = [], ONE
    while exponent > 1 or (exponent and power is TEXTURE1):
        last = exponent == 1
        portion = NOTHING if last else square(SPARE1, to=SPARE1)
        if exponent & 1:
            portion = both(portion, product(SPARE1, power, to=SPARE1 if last else TEXTURE1))
            power = TEXTURE1
        stages.append(stage(portion))
        exponent >>= 1
    return tuple(stages)


def _shades(picture, profile):
    """The programs that draw what does not depend on the lamp, and its light."""
    shading = picture.shading
    dots = _dots(profile, picture.light, picture.half)
    if shading.mask:
        # 64 n.l: above one half where n.l is above LEAST.
        times_four = scaled(4, total(SPARE0, to=SPARE0))
        white = program(dots, times_four, times_four, times_four, shown(SPARE0))
        return program(shown(ZERO, alpha=TEXTURE0)), white
    first = program(
        _dots(profile, picture.eye, picture.eye),
        final(SPARE0, CONSTANT0, plus=CONSTANT1, alpha=TEXTURE0),
        constant0=shading.times(shading.fill),
        constant1=shading.times(shading.ambient),
    )
    light = program(
        dots,
        *_raised(shading.exponent),
        final(SPARE0, CONSTANT0, plus=product(SPARE1, CONSTANT1)),
        constant0=shading.times(shading.diffuse),
        constant1=(shading.specular,) * 3,
    )
    return first, light


def combiners(picture, profile, load=True):
    """H39 by register combiners: a ``Picture``'s commands.

    ``profile``: a machine with 3D textures; one general combiner more than the exponent has bits, with
    constants of each stage; and for shadows two texture units. ``load``: False where the volume is loaded
    already.
    """
    slices = Slices(picture.volume, picture.view, picture.slices)
    first, light = _shades(picture, profile)
    store = marking = ()
    marked = {}
    if picture.map_panel is not None:
        coding, lamp = picture.coding, picture.lamp
        texel = program(shown(ZERO, alpha=TEXTURE0))
        store = light_map(
            picture.volume, lamp, picture.map_panel, picture.slices, profile, coding, texel, texel
        )
        units = coding.ramp_unit(lamp, picture.view), map_unit(lamp, picture.view)
        marking = (
            slices.again(
                "mark what is not behind the map: ramp - map = 0",
                units,
                difference_combiners(),
                alpha_test=EQUAL_ZERO,
                stencil_test=MARK,
                color_mask=NO_COLOR,
            ),
        )
        marked = {"stencil_test": MARKED}
    return (
        *((picture.load(127.5 if profile.arithmetic.exact else 128.0),) if load else ()),
        *store,
        clear_window(picture.view, checked_rgb(picture.background)),
        slices.solid("slices: light that is not the lamp's", first),
        *marking,
        slices.again("plus the lamp's light", (slices.unit,), light, blending=ADD, **marked),
    )


def method_of(profile):
    """``imaging`` or ``combiners``, which a machine can draw. Raises ValueError where it can neither."""
    if (
        profile.textures.max_3d_texture_size
        and profile.pixels.color_matrix
        and profile.framebuffers.auxiliary_buffers
    ):
        return imaging
    if (
        profile.textures.max_3d_texture_size
        and profile.combiners.max_general_combiners >= 6
        and profile.combiners.per_stage_constants
    ):
        return combiners
    raise ValueError(
        f"The {profile.name} cannot light slices of a 3D texture, which takes 3D textures and either a "
        "colour matrix and auxiliary buffers, or six general combiners."
    )
