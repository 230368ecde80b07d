"""H39: iso-surfaces of a volume by slices of a 3D texture, lit by Phong's model, with alpha-coded shadows.

The 3D texture holds a unit normal n as n/2 + 1/2 in RGB and the density in alpha. n points to where the
density falls: it is the gradient's negative, normalized at every voxel that has a gradient, by central
differences of the bytes. Between voxels the filter shortens it; no machine here makes it longer again, and so
creases are darker than they would be. The passes:

P0  Shadows only. From the light: slices with the alpha test GEQUAL iso and DF LESS, no colours; the slices
    again with DF EQUAL and a 1D ramp of the light's depth instead of the volume, whose alpha becomes the map
    TA (H36).
P1  From the camera: slices through the volume, parallel to the image plane, in any order; alpha test GEQUAL
    iso, DF LESS, no blending. Of all slices beyond the iso-surface the nearest stays: RGB is n there.
P2  Light: the picture is copied onto itself through a colour matrix whose row is l, which gives n.l, and a
    table, (.)+ times the colour; once more for the highlight, the table being the exponent's power of n.h.

``imaging``, for machines with the imaging subset and one texture unit:

- P1 draws into an auxiliary buffer: the second copy needs the normals that the first would overwrite, and
  destination alpha has other work. Copies go from there to the window's buffer, only where P1 left its mark
  in the stencil buffer. One copy gives what does not depend on the lamp: ambient light, and a weak light
  from the eye so that shadows keep their shapes.
- n.l below zero is lost when the colour matrix's results are clamped, on an Octane as they leave it, else by
  the table. That is (.)+, so nothing is biased (P15 does no harm here).
- Shadows (H38): slices with DF EQUAL write the ramp to destination alpha, the same with TA are subtracted,
  a copy multiplies alpha by 2^n, and light is added with ONE_MINUS_DST_ALPHA.

``combiners``, for register combiners and two units, shades while it draws slices: P1 with what does not
depend on the lamp; slices with ramp and TA (H37), whose difference the alpha test compares with 0 and the
stencil buffer marks; slices with DF EQUAL where marked, which add n.l and (n.h)^N.

One light vector and one halfway vector serve the whole picture: the light is directional, and the viewer is
taken as infinitely far, though slices may be seen in perspective. Slices are drawn only in bricks of the
volume in which the surface may be seen.

Source: Heidrich 2001, section 2.1 and figure 7, which names Westermann and Ertl 1998 for the light; pass
sequences A-H36 to A-H39 of the catalogue.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import Panel, View
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    MARK,
    MARKED,
    NO_ALPHA,
    NO_RGB,
    ONE,
    OPAQUE,
    REPLACE,
    SUBTRACT,
    ZERO,
    alpha_of,
    checked_rgb,
    expand,
)
from fixedpipe.effects.passes.encoding import encode_expand
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, lamp_around
from fixedpipe.effects.shadows.alpha_coded_shadows import (
    ADD_WHERE_ALPHA_IS_ZERO,
    BIAS,
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
from fixedpipe.effects.shadows.lit_scene import NO_COLOR, map_edge
from fixedpipe.pipeline.commands import Clear, CopyPixels, CopyTexImage, Draw, Mesh, Saturate, TexImage
from fixedpipe.pipeline.enums import (
    ColorBuffer,
    CombinerScale,
    ComparisonFunction,
    Register,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.pixel_transfer import PixelTransfer
from fixedpipe.pipeline.state import (
    AlphaTest,
    ColorTable,
    CombinerInput,
    FinalCombiner,
    GeneralCombiner,
    PassState,
    RasterPosition,
    RegisterCombiners,
    RGBPortion,
    Sampler,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_3d

# Source: catalogue, A-H39.
EXPONENT = 30
# Voxels along a brick's edge.  Measured: at 512 pixels with 256 slices bricks of 8, 16 and 32 voxels make 61,
# 69 and 95 million fragments, and those of 16 are drawn fastest.
BRICK = 16
# A mask shows as lit what gets this much of the lamp's light, n.l, or more: below, bytes say little.
LEAST = 1.0 / 128.0
# Assumed: of a colour table, entries enough for every byte of n.l and the exponent's steepest place.
TABLE_ENTRIES = 4096

_NORMALS = ColorBuffer.AUX0
_BACKGROUND = (0.07, 0.075, 0.09)
_VOLUME = Sampler(EDGE.min_filter, EDGE.mag_filter, EDGE.wrap_s, EDGE.wrap_t, wrap_r=WrapMode.CLAMP_TO_EDGE)
# A box's corners, whose numbers have bits x, y and z, and its twelve edges.
_BITS = np.array([[k >> axis & 1 for axis in range(3)] for k in range(8)])
_EDGES = np.array([(a, a | bit) for bit in (1, 2, 4) for a in range(8) if not a & bit])


# ----------------------------------------------------------------------------------------------- volumes


def stored_normals(density, spacing=(1.0, 1.0, 1.0), zero=127.5):
    """Unit vectors n to where a density falls as ``zero`` + 127.5 n: uint8 [layers, rows, columns, 3].

    ``density``: uint8 [layers, rows, columns]; beyond is nothing. ``spacing``: of the voxels along x
    (columns), y and z. Differences are central; where all three are zero so is n, and 128 is stored.
    """
    out = np.full((*density.shape, 3), 128, np.uint8)
    padded = np.pad(density, 1).astype(np.int16)
    inside = slice(1, -1)
    for k, layer in enumerate(out):
        here = padded[k + 1]
        falls = [
            here[inside, :-2] - here[inside, 2:],
            here[:-2, inside] - here[2:, inside],
            (padded[k] - padded[k + 2])[inside, inside],
        ]
        where = np.nonzero((falls[0] != 0) | (falls[1] != 0) | (falls[2] != 0))
        vectors = [fall[where] / width for fall, width in zip(falls, spacing, strict=True)]
        normals = normalize(np.stack(vectors, axis=-1))
        layer[where] = np.minimum(np.floor(zero + 127.5 * normals + 0.5), 255.0)
    return out


@dataclass(frozen=True, eq=False)
class Volume:
    """Densities and the iso-surface that is drawn of them.

    name          the texture object's, too
    density       uint8 [layers, rows, columns], z, y and x from the lowest
    half_extents  of the box that the voxels fill, centred at the origin, world units
    iso           density of the surface, (0, 1): what is as dense or denser is solid
    """

    name: str
    density: np.ndarray
    half_extents: tuple[float, float, float]
    iso: float = 0.5
    _stored: dict = field(default_factory=dict, repr=False)

    def __post_init__(self):
        if self.density.ndim != 3 or self.density.dtype != np.uint8:
            raise ValueError(
                f"The densities are {self.density.dtype} of shape {self.density.shape}; give bytes "
                "[layers, rows, columns]."
            )
        if not 0.0 < self.iso < 1.0:
            raise ValueError(f"The iso-surface's density is {self.iso}; give one between 0 and 1.")

    def corners(self):
        """The corners of the box round its bricks, float64 [8, 3], the bits of their numbers telling x, y and
        z. Raises ValueError where the iso-surface is nowhere.
        """
        bricks = self.seen_bricks()
        low, high = bricks.min(axis=0), bricks.max(axis=0)
        return self.brick_corners(np.where(_BITS, high + 1, low))

    def seen_bricks(self):
        """``bricks`` of the densities. Raises ValueError where the iso-surface is nowhere."""
        if not len(self._bricks):
            raise ValueError(
                f"No density of {self.name} reaches {self.iso:g}: it has no surface there; give less."
            )
        return self._bricks

    def brick_corners(self, numbers):
        """Where brick corners [..., 3] of these numbers lie, world coordinates."""
        grid, half = np.array(self.density.shape[::-1]), np.array(self.half_extents)
        return 2.0 * half * (np.minimum(numbers * BRICK, grid) / grid) - half

    @cached_property
    def _bricks(self):
        return bricks(self.density, math.ceil(255.0 * self.iso))

    def texture(self, zero):
        """The 3D texture, RGBA8: normals n as ``zero`` + 127.5 n in RGB, densities in alpha.

        The exact machine gets the same bytes: they are data, of which a scanner has no more.
        """
        if zero not in self._stored:
            counts = reversed(self.density.shape)
            spacing = [h / n for h, n in zip(self.half_extents, counts, strict=True)]
            normals = stored_normals(self.density, spacing, zero)
            self._stored[zero] = texture_3d(np.concatenate([normals, self.density[..., None]], axis=-1))
        return self._stored[zero]


# ------------------------------------------------------------------------------------------------ slices


def bricks(density, iso, edge=BRICK):
    """Which parts of a volume slices have to be drawn in: int64 [k, 3], x, y and z, counted in bricks.

    Bricks of ``edge`` voxels along each axis are left out where nothing within a voxel of them is as dense as
    the byte ``iso``, and where everything within ``edge`` voxels of them is: no camera's nearest slice beyond
    the iso-surface lies there, if slices are less than ``edge`` voxels apart. Beyond the volume is nothing.
    """
    counts = [-(-n // edge) for n in density.shape]
    padded = np.pad(
        density, [(1, edge * c - n + 1) for c, n in zip(counts, density.shape, strict=True)], mode="edge"
    )
    dense, hollow = np.zeros(counts, bool), np.zeros(counts, bool)
    for at in np.ndindex(*counts):
        part = padded[tuple(slice(edge * k, edge * k + edge + 2) for k in at)]
        dense[at], hollow[at] = part.max() >= iso, part.min() < iso
    around = np.pad(hollow, 1, constant_values=True)
    near = np.zeros_like(hollow)
    for dz, dy, dx in np.ndindex(3, 3, 3):
        near |= around[dz : dz + counts[0], dy : dy + counts[1], dx : dx + counts[2]]
    return np.argwhere(dense & near)[:, ::-1]


def slice_mesh(volume, view, count):
    """A volume cut by ``count`` planes parallel to the image, evenly spaced from the nearest to the farthest
    corner of its ``bricks``, in these alone, the nearest first: triangles with (s, t, r).

    The surface lies in front of the first plane beyond it, by half a step on average; so much nearer to the
    eye is a polygon than where it cuts the volume. What it shows is then as often too near as too far.

    Raises ValueError where the iso-surface is nowhere.
    """
    # Brick by brick: the twelve edges of each, by their ends' distances from the eye along the view.
    side, up, back, _ = view.modelview

    def eye_depth(points):
        return -(((points[..., 0] * back[0] + points[..., 1] * back[1]) + points[..., 2] * back[2]) + back[3])

    corners = volume.brick_corners(volume.seen_bricks()[:, None] + _BITS)
    depths = eye_depth(corners)
    least, step = float(depths.min()), (float(depths.max()) - float(depths.min())) / count
    # Plane k lies k + 1/2 steps behind the nearest corner.
    first = np.ceil((depths.min(axis=1) - least) / step - 0.5).astype(np.int64)
    last = np.floor((depths.max(axis=1) - least) / step - 0.5).astype(np.int64)
    first, last = np.maximum(first, 0), np.minimum(last, count - 1)
    number = np.maximum(last - first + 1, 0)
    brick = np.repeat(np.arange(len(number)), number)
    plane = np.arange(len(brick)) - np.repeat(np.cumsum(number) - number - first, number)
    order = np.argsort(plane, kind="stable")
    brick, distance = brick[order], (least + (plane[order] + 0.5) * step)[:, None]

    ends = [corners[brick][:, _EDGES[:, k]] for k in (0, 1)]
    near, far = (depths[brick][:, _EDGES[:, k]] for k in (0, 1))
    # Half open, so that a plane through a corner still cuts a closed polygon.
    cut = (near >= distance) != (far >= distance)
    along = np.where(cut, (distance - near) / np.where(cut, far - near, 1.0), 0.0)[..., None]
    points = ends[0] + along * (ends[1] - ends[0])
    corner_count = cut.sum(axis=1)
    kept = corner_count >= 3
    cut, points, corner_count = cut[kept], points[kept], corner_count[kept]
    # Round each polygon's middle, by a number that grows with the angle.
    total = np.zeros((len(points), 3))
    for k in range(len(_EDGES)):
        total = total + np.where(cut[:, k, None], points[:, k], 0.0)
    away = points - (total / corner_count[:, None])[:, None]
    x, y = (((away[..., 0] * row[0] + away[..., 1] * row[1]) + away[..., 2] * row[2]) for row in (side, up))
    size = np.abs(x) + np.abs(y)
    turn = x / np.where(size > 0.0, size, 1.0)
    order = np.argsort(np.where(cut, np.where(y < 0.0, turn - 1.0, 1.0 - turn), 9.0), axis=1, kind="stable")
    ordered = np.take_along_axis(points, order[..., None], axis=1)[:, :6]
    # A fan of as many triangles as there are corners after the first two.
    fan = ordered[:, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]]
    half = np.array(volume.half_extents)
    found = fan[np.arange(4) < corner_count[:, None] - 2].reshape(-1, 3)
    return Mesh(
        positions=_half_a_step_nearer(found, view, eye_depth(found)[:, None], 0.5 * step),
        texture_coordinates=((found + half) / (2.0 * half),),
    )


def _half_a_step_nearer(points, view, depths, distance):
    """Points moved along their rays to the eye by a ``distance`` of depth."""
    if view.infinite_viewer:
        return points + distance * np.array(view.modelview[2][:3])
    eye = np.array(view.eye)
    return eye + (points - eye) * ((depths - distance) / depths)


@dataclass(frozen=True, eq=False)
class Slices:
    """A volume's slices in one view, ``count`` of them."""

    volume: Volume
    view: View
    count: int

    @cached_property
    def mesh(self):
        """The polygons that every pass draws."""
        return slice_mesh(self.volume, self.view, self.count)

    @property
    def unit(self):
        """The texture unit that reads the volume."""
        return TextureUnit(self.volume.name, _VOLUME, environment=REPLACE)

    def solid(self, label, combiners=None, **settings):
        """P1: the nearest slice at each pixel whose density is the iso-surface's or more."""
        inside = AlphaTest(ComparisonFunction.GEQUAL, self.volume.iso)
        settings = {"alpha_test": inside, "depth_test": FIRST_PASS, **settings}
        return self.again(label, (self.unit,), combiners, **settings)

    def again(self, label, units, combiners=None, **settings):
        """The slices once more, with DF EQUAL."""
        state = PassState(
            vertex=self.view.vertex,
            texture_units=tuple(units),
            register_combiners=combiners,
            scissor=self.view.panel.scissor,
            **{"depth_test": LATER_PASS, **settings},
        )
        return Draw(label=label, mesh=self.mesh, state=state)


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
            label="copy it as the map", texture=MAP, internal_format=coding.internal_format(profile),
            x=panel.x, y=panel.y, width=panel.width, height=panel.height,
        ),
    )  # fmt: skip


def _shadow_alpha(slices, lamp, profile, coding):
    """H38: destination alpha one in shadow, zero in light, where P1 left a surface."""
    view = slices.view
    ramp = coding.ramp_unit(lamp, view, environment=REPLACE)
    projected = map_unit(lamp, view, environment=REPLACE)
    return (
        slices.again("alpha = depth from the light", (ramp,), color_mask=ONLY_ALPHA),
        slices.again("minus the map", (projected,), blending=SUBTRACT, color_mask=ONLY_ALPHA),
        Saturate(label="alpha in [0, 1]", scissor=view.panel.scissor),
        scale_alpha(view.panel, profile.color_bits[0]),
        Saturate(label="alpha 0 or 1", scissor=view.panel.scissor),
    )


# --------------------------------------------------------------------------------- Phong's model of a picture


@dataclass(frozen=True)
class Shading:
    """Phong's model, RGB from 0 to 1.

    color     of the surface, by which ambient and diffuse light are multiplied
    ambient   light from everywhere
    fill      a weak light from the eye, whose shadows nobody sees; it and ambient light are everywhere
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
    lamp        an infinite ``scenes.Lamp``
    slices      how many, in both views
    shading     the Shading
    map_panel   a square Panel of the window in which the shadow map is drawn, of as many pixels as the map
                has texels, a power of two; what was there is lost. None: no shadows
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
    return profile.max_color_table_size if profile.exact else min(profile.max_color_table_size, TABLE_ENTRIES)


def _through(vector, table):
    """Pixel transfer of stored normals: n.v by the colour matrix, then a table of (n.v)+."""
    row = (*(2.0 * c for c in vector), 0.0)
    less = -((vector[0] + vector[1]) + vector[2])
    return PixelTransfer(
        color_matrix=(row,) * 4, post_color_matrix_bias=(less,) * 4, post_color_matrix_color_table=table
    )


def _copy(label, view, transfer, **settings):
    """Marked pixels of a panel, from the buffer of normals to the window's."""
    panel = view.panel
    return CopyPixels(
        label=label,
        x=panel.x,
        y=panel.y,
        width=panel.width,
        height=panel.height,
        state=PassState(scissor=panel.scissor, stencil_test=MARKED, color_mask=ONLY_RGB, **settings),
        position=RasterPosition(position=(float(panel.x), float(panel.y), 0.0, 1.0), window=True),
        transfer=transfer,
        read_buffer=_NORMALS,
    )


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

_TEXEL, _SPARE0, _SPARE1 = Register.TEXTURE0, Register.SPARE0, Register.SPARE1
_CURRENT, _PRODUCT = CombinerInput(_SPARE1), CombinerInput(Register.TEXTURE1)
_CONSTANT0, _CONSTANT1 = CombinerInput(Register.CONSTANT_COLOR0), CombinerInput(Register.CONSTANT_COLOR1)
_NO_OUTPUT = dict.fromkeys(("ab_output", "cd_output", "sum_output"), Register.DISCARD)
_NO_COMBINER = GeneralCombiner(NO_RGB, NO_ALPHA)


def _encoded(vector, profile):
    stored = encode_expand(np.array(vector), profile)
    return (*(stored if profile.exact else stored / 255.0).tolist(), 0.0)


def _dots(profile, first, second):
    """A general combiner: n.first to spare 0, n.second to spare 1."""
    rgb = RGBPortion(
        a=expand(_TEXEL),
        b=expand(Register.CONSTANT_COLOR0),
        c=expand(_TEXEL),
        d=expand(Register.CONSTANT_COLOR1),
        ab_output=_SPARE0,
        cd_output=_SPARE1,
        sum_output=Register.DISCARD,
        ab_dot_product=True,
        cd_dot_product=True,
    )
    constants = _encoded(first, profile), _encoded(second, profile)
    return GeneralCombiner(rgb, NO_ALPHA, constant_color0=constants[0], constant_color1=constants[1])


def _raised(exponent):
    """General combiners that raise spare 1 to a whole power: each squares it, and multiplies texture 1 by
    what was squared where the exponent has that bit. The last leaves the product in spare 1.
    """
    stages, product = [], ONE
    while exponent > 1 or (exponent and product is _PRODUCT):
        rgb = RGBPortion(a=ZERO, **_NO_OUTPUT)
        if exponent > 1:
            rgb = replace(rgb, a=_CURRENT, b=_CURRENT, ab_output=_SPARE1)
        if exponent & 1:
            rgb = replace(
                rgb, c=_CURRENT, d=product, cd_output=Register.TEXTURE1 if exponent > 1 else _SPARE1
            )
            product = _PRODUCT
        stages.append(GeneralCombiner(rgb, NO_ALPHA))
        exponent >>= 1
    return tuple(stages)


def _times_four(register):
    rgb = RGBPortion(a=CombinerInput(register), b=ONE, sum_output=register, scale=CombinerScale.SCALE_BY_FOUR)
    return GeneralCombiner(rgb, NO_ALPHA)


def _final(a=ZERO, b=ZERO, d=ZERO, e=ZERO, f=ZERO, g=OPAQUE):
    """A b + d, where d may be e f."""
    return FinalCombiner(a=a, b=b, c=ZERO, d=d, e=e, f=f, g=g)


def _shades(picture, profile):
    """The programs that draw what does not depend on the lamp, and its light."""
    shading, density = picture.shading, alpha_of(_TEXEL)
    dots = _dots(profile, picture.light, picture.half)
    if shading.mask:
        black = RegisterCombiners(general=(_NO_COMBINER,), final=_final(g=density))
        # 64 n.l: above one half where n.l is above LEAST.
        white = RegisterCombiners(
            general=(dots, *(_times_four(_SPARE0),) * 3), final=_final(d=CombinerInput(_SPARE0))
        )
        return black, white
    first = RegisterCombiners(
        general=(_dots(profile, picture.eye, picture.eye),),
        final=_final(CombinerInput(_SPARE0), _CONSTANT0, _CONSTANT1, g=density),
        constant_color0=(*shading.times(shading.fill), 1.0),
        constant_color1=(*shading.times(shading.ambient), 1.0),
    )
    highlight = CombinerInput(Register.E_TIMES_F)
    light = RegisterCombiners(
        general=(dots, *_raised(shading.exponent)),
        final=_final(CombinerInput(_SPARE0), _CONSTANT0, highlight, _CURRENT, _CONSTANT1),
        constant_color0=(*shading.times(shading.diffuse), 1.0),
        constant_color1=(*(shading.specular,) * 3, 1.0),
    )
    return first, light


def combiners(picture, profile, load=True):
    """H39 by register combiners: a ``Picture``'s commands.

    ``profile``: with 3D textures and as many general combiners, with constants of each stage, as the exponent
    has bits and one more; for shadows two texture units. ``load``: False where the volume is loaded already.
    """
    slices = Slices(picture.volume, picture.view, picture.slices)
    first, light = _shades(picture, profile)
    store = marking = ()
    marked = {}
    if picture.map_panel is not None:
        coding, lamp = picture.coding, picture.lamp
        texel = RegisterCombiners(general=(_NO_COMBINER,), final=_final(g=alpha_of(_TEXEL)))
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
        *((picture.load(127.5 if profile.exact else 128.0),) if load else ()),
        *store,
        clear_window(picture.view, checked_rgb(picture.background)),
        slices.solid("slices: light that is not the lamp's", first),
        *marking,
        slices.again("plus the lamp's light", (slices.unit,), light, blending=ADD, **marked),
    )


# ------------------------------------------------------------------------------------ pictures of any volume


def method_of(profile):
    """``imaging`` or ``combiners``, which a machine can draw. Raises ValueError where it can neither."""
    if profile.max_3d_texture_size and profile.color_matrix and profile.auxiliary_buffers:
        return imaging
    if profile.max_3d_texture_size and profile.max_general_combiners >= 6 and profile.per_stage_constants:
        return combiners
    raise ValueError(
        f"The {profile.name} cannot light slices of a 3D texture: that takes 3D textures and a colour "
        "matrix, as the OCTANE's, or six general combiners, as the GEFORCE_3's."
    )


def bias_of(bits, slices, edge):
    """The map's bias in steps of depth: two steps of a byte, or as much as two slices or two of the map's
    ``edge`` texels where these are coarser.

    Both are no finer on a machine of 12 bits, whose steps are a sixteenth.
    """
    return BIAS * (2**bits - 1) / min(slices, edge, 255)


def picture_of(volume, eye, up, light, profile, size, slices, shadows):
    """A ``Picture`` of ``size`` by ``size`` pixels that shows all of a volume's surface.

    ``eye``, ``up``, ``light``: directions, three floats; the first to the viewer, the last to the lamp.
    Raises ValueError where the eye looks along ``up``, there is no surface, or a flat volume would fall
    through between the slices.
    """
    corners = volume.corners()
    center = corners.min(axis=0) * 0.5 + corners.max(axis=0) * 0.5
    toward = unit_vector(eye, "The direction to the eye")
    across = cross(unit_vector(up, "What is up"), toward)
    if dot(across, across) < 1e-6:
        raise ValueError(f"The eye looks along {up}, which is to be up; give another direction.")
    side = normalize(across)
    points = volume.brick_corners(volume.seen_bricks()[:, None] + _BITS).reshape(-1, 3) - center
    x, y, z = (dot(points, axis) for axis in (side, cross(toward, side), toward))
    # What is flat and seen aslant must be deeper along the view than slices are apart.
    step = float(z.max() - z.min()) / slices
    depths = 2.0 * np.array(volume.half_extents) / np.maximum(np.abs(toward), 1e-12)
    if depths.min() < step:
        raise ValueError(
            f"Slices are {step:.3g} units apart, and {volume.name} is {depths.min():.3g} deep where the eye "
            "looks through its thinnest edge: it would have holes. Give more slices, another direction to "
            "the eye, or another spacing."
        )
    # A field of view of 24 degrees, 0.2126 its half's tangent, and a margin round what is seen.
    distance = float((np.maximum(np.abs(x), np.abs(y)) * (1.04 / 0.2126) + z).max())
    position = tuple((center + distance * toward).tolist())
    # Slices come half a step nearer than the volume.
    depth = 0.05 * float(z.max() - z.min())
    projection = perspective(24.0, 1.0, distance - float(z.max()) - depth, distance - float(z.min()) + depth)
    modelview = look_at(position, tuple(center.tolist()), up)
    lamp = center + 4.0 * unit_vector(light, "The direction to the light")
    edge = map_edge(size, 1)
    bits = profile.color_bits[0]
    return Picture(
        volume,
        View(Panel(0, 0, size, size), modelview, projection, position, False),
        lamp_around(volume, tuple(lamp.tolist()), tuple(center.tolist()), infinite=True),
        slices,
        map_panel=Panel(0, 0, edge, edge) if shadows else None,
        coding=Coding(bits=bits, bias=bias_of(bits, slices, edge)),
        background=_BACKGROUND,
    )
