"""H17 and H18 drawn: products of maps of directions.

The maps are looked up along light, view, halfway and difference vectors, which are computed at the vertices.

The result is pi f_r (n.l)+ times the light's intensity, so a white surface that faces a light of one is full.
With enough units, a product of textures is one draw; otherwise one draw multiplies another's picture. Further
terms are added. Their factors have signs, so there are three ways:

    blending      halves of one sign each, textures as they are: products of like halves are added, those of
                  unlike ones are subtracted, by a blend equation or between two inversions of the picture
    combiners     textures that EXPAND_NORMAL reads; a product's positive part adds, and its negative part
                  subtracts. With four units two terms are one sum in a combiner
    accumulation  the halves again. The window draws each product by itself, and the accumulation buffer adds
                  or subtracts it: for boards with one unit

A term's scale is the largest product of its factors; it goes into the vertices' colour, with n.l. If it
exceeds one, the picture is drawn at a half or a quarter and doubled at the end. The combiners' output
doubles, or the accumulation buffer, or a white draw that adds the picture to itself. Beyond four the first
map is clamped.

Source: Kautz, McCool 1999; McCool, Ang, Ahmad 2001; Heidrich 2001, section 1.1.2 (A-H17 and A-H18 of the
catalogue). Chosen: how signs are stored, and the doubling.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.vertex_vectors import light_vectors, view_vectors
from fixedpipe.effects.passes.combiners import (
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE1,
    TEXTURE2,
    TEXTURE3,
    expand,
    negated,
    product,
    program,
    scaled,
    shown,
    signed,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    EDGE,
    FIRST_PASS,
    INVERT_DESTINATION,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION,
    SUBTRACT,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import factor_texels, vector_texels
from fixedpipe.effects.reflectance import hemisphere_maps
from fixedpipe.effects.reflectance.hemisphere_maps import Halves
from fixedpipe.effects.reflectance.homomorphic_factors import HomomorphicFactors
from fixedpipe.effects.technique import Variant
from fixedpipe.pipeline.commands import Accum, Clear, Saturate, TexImage
from fixedpipe.pipeline.enums import AccumOperation, BlendEquation, BlendFactor, InternalFormat, TextureTarget
from fixedpipe.pipeline.state import Blending
from fixedpipe.pipeline.textures.images import texture_2d, texture_cube_map

TECHNIQUES = (Variant(("H17", "H18"), "as passes of each machine"),)

# The picture twice: a white draw adds what is there.
_DOUBLE = Blending(BlendFactor.DST_COLOR, BlendFactor.ONE)
LARGEST_BOOST = 4.0
# The least z of the directions whose values a map has to hold; what is larger nearer to the horizon is cut
# off, as it may be a thousand times what the picture shows elsewhere.  Chosen: fifteen degrees above the
# horizon for factors of light and view; thirty for the others, where 1 / z, which highlights have in several
# factors at once, is two.
LOWEST, LOWEST_OF_HIGHLIGHTS = 0.25, 0.5
_TEXTURES = (TEXTURE0, TEXTURE1, TEXTURE2, TEXTURE3)


class Storage(Enum):
    """Where a factor is kept."""

    CUBE = "cube maps"
    PARABOLIC = "parabolic maps"


class Means(Enum):
    """How products come together."""

    COMBINERS = "register combiners"
    BLENDING = "texture environments and blending"
    ACCUMULATION = "accumulation buffer"


@dataclass(frozen=True)
class Board:
    """The properties of a machine that decide how factors are drawn.

    units      texture units; passes use 1, 2 or more of them
    subtracts  whether blending can subtract
    """

    means: Means
    storage: Storage
    units: int
    subtracts: bool

    @property
    def together(self) -> int:
        """How many products of two textures one combiner adds."""
        both = self.means is Means.COMBINERS and self.units >= len(_TEXTURES)
        return 2 if both else 1


def board_of(profile, storage=None):
    """The Board of a machine. ``storage``: None, cube maps where it has them.

    Raises ValueError for cube maps on a machine without.
    """
    cubes = TextureTarget.TEXTURE_CUBE_MAP in profile.textures.texture_targets
    if storage is Storage.CUBE and not cubes:
        raise ValueError("The machine has no cube maps; store the factors in parabolic maps.")
    units = profile.textures.max_texture_units
    if profile.combiners.max_general_combiners >= 2 and units >= 2:
        means = Means.COMBINERS
    elif units >= 2 or not profile.framebuffers.accumulation_bits:
        means = Means.BLENDING
    else:
        means = Means.ACCUMULATION
    return Board(
        means,
        storage or (Storage.CUBE if cubes else Storage.PARABOLIC),
        units,
        BlendEquation.FUNC_REVERSE_SUBTRACT in profile.fragments.blend_equations,
    )


# ------------------------------------------------------------------------------------------- textures


@dataclass(frozen=True)
class Lookup:
    """A texture and the vector it is looked up along: "light", "view", "half" or "difference"."""

    texture: str
    along: str


@dataclass(frozen=True)
class Product:
    """Lookups that are multiplied, and the sign with which the product counts; ``stored_signed``: textures
    that EXPAND_NORMAL reads.
    """

    lookups: tuple[Lookup, ...]
    sign: int = 1
    stored_signed: bool = False


@dataclass(frozen=True, eq=False)
class LoadedFactors:
    """A mesh is drawn with these: ``products`` of loaded textures, the first positive; ``color``, float64
    [3], which multiplies their sum along with n.l; ``boost``, 1, 2 or 4, which multiplies it at the end.
    """

    board: Board
    products: tuple[Product, ...]
    color: np.ndarray
    boost: float


def _boost_of(scale):
    return float(next((b for b in (1.0, 2.0) if scale.max() <= b), LARGEST_BOOST))


def _peaks(image, lowest):
    """The largest of a map's values well above the horizon, which a texture of bytes has to hold: [3]."""
    high = hemisphere_maps.directions(len(image))[..., 2] >= lowest
    peak = np.abs(image[high]).max(axis=0)
    return np.where(peak > 0.0, peak, 1.0)


class _Loading:
    """Commands that load maps as a board keeps them."""

    def __init__(self, board, name, size, profile):
        self.board, self.name, self.size, self.profile, self.commands = board, name, size, profile, []

    def load(self, image, what, stored_signed=False):
        """A map [n, n, 3] in [0, 1] or [-1, 1] as a texture: its name."""
        cube = self.board.storage is Storage.CUBE
        values = hemisphere_maps.cube(image, self.size) if cube else image
        texels = vector_texels(values, self.profile) if stored_signed else factor_texels(values, self.profile)
        texture = f"{self.name} {what}"
        stored = (texture_cube_map if cube else texture_2d)(texels, InternalFormat.RGB8)
        self.commands.append(TexImage(label=f"load {what} of {self.name}", texture=texture, image=stored))
        return texture

    def halves(self, image, what, along):
        """The parts of a signed map that are not zero everywhere: by sign, their Lookups."""
        out = {}
        for sign, word in ((1, "+"), (-1, "-")):
            part = np.maximum(0.0, sign * image)
            if part.any():
                out[sign] = Lookup(self.load(part, f"({what}){word}", False), along)
        return out


def load(factors, name, profile, *, intensity=1.0, board=None):
    """Commands that load SeparableFactors or HomomorphicFactors, and the LoadedFactors.

    intensity  of the light: a white surface that faces it has this brightness
    board      a Board; None: the machine's

    Raises ValueError for an intensity that is not positive.
    """
    if not 0.0 < intensity < math.inf:
        raise ValueError(f"The light's intensity is {intensity!r}; give a positive number.")
    board = board_of(profile) if board is None else board
    loading = _Loading(board, name, factors.size, profile)
    full = math.pi * float(intensity)
    if isinstance(factors, HomomorphicFactors):
        peak, half_peak = (_peaks(image, LOWEST_OF_HIGHLIGHTS) for image in (factors.direction, factors.half))
        scale = full * factors.scale * (peak * peak) * half_peak
        boost = _boost_of(scale)
        color = np.minimum(scale / boost, 1.0)
        direction = np.minimum(factors.direction / peak, 1.0)
        half = np.minimum(factors.half / half_peak * np.maximum(scale / boost, 1.0), 1.0)
        p, q = loading.load(direction, "p"), loading.load(half, "q")
        products = (Product((Lookup(p, "light"), Lookup(q, "half"), Lookup(p, "view"))),)
    else:
        products, color, boost = _separable(factors, full, loading)
    return tuple(loading.commands), LoadedFactors(board, products, color, boost)


def _separable(factors, full, loading):
    along, lowest = ("half", "difference"), LOWEST_OF_HIGHLIGHTS
    if factors.halves is Halves.LIGHT_AND_VIEW:
        along, lowest = ("light", "view"), LOWEST
    pairs = []
    for u, v in zip(factors.first, factors.second, strict=True):
        peak = _peaks(v, lowest)
        pairs.append((full * u * peak, np.clip(v / peak, -1.0, 1.0)))
    # All terms have one colour, and what a combiner adds has to be one at the most.
    together = loading.board.together
    sums = [sum(np.abs(u) for u, _ in pairs[k : k + together]) for k in range(0, len(pairs), together)]
    scale = np.max([_peaks(each, lowest) for each in sums], axis=0)
    boost = _boost_of(scale)
    color = np.minimum(scale / boost, 1.0)
    products = []
    for k, (u, v) in enumerate(pairs):
        u = np.clip(u / (boost * color), -1.0, 1.0)
        names = f"u{k + 1}", f"v{k + 1}"
        if k == 0:
            lookups = (loading.load(np.maximum(u, 0.0), names[0]), loading.load(np.maximum(v, 0.0), names[1]))
            products.append(Product(tuple(map(Lookup, lookups, along))))
        elif loading.board.means is Means.COMBINERS:
            lookups = (loading.load(u, names[0], True), loading.load(v, names[1], True))
            products.append(Product(tuple(map(Lookup, lookups, along)), stored_signed=True))
        else:
            first = loading.halves(u, names[0], along[0])
            second = loading.halves(v, names[1], along[1])
            products += [
                Product((first[a], second[b]), a * b)
                for a in (1, -1)
                for b in (1, -1)
                if a in first and b in second
            ]
    # What adds comes before what is taken off, as a picture of bytes does not fall below zero.
    return tuple(sorted(products, key=lambda each: -each.sign)), color, boost


# --------------------------------------------------------------------------------------------- vectors


def _vectors(surface, view, light):
    """Vectors at the vertices, in their frames, by name, and n.l: what is below the horizon is drawn up."""
    towards, views = light_vectors(surface, light), view_vectors(surface, view)
    cosine = np.maximum(towards[:, 2], 0.0)
    lights, seen = (normalize(hemisphere_maps.above(vectors)) for vectors in (towards, views))
    half, difference = hemisphere_maps.halfway_and_difference(lights, seen)
    return {"light": lights, "view": seen, "half": half, "difference": difference}, cosine


class _Passes:
    """Draws of one surface by LoadedFactors."""

    def __init__(self, surface, loaded, view, light, lit):
        self.surface, self.loaded, self.view, self.out = surface, loaded, view, []
        vectors, cosine = _vectors(surface, view, light)
        cube = loaded.board.storage is Storage.CUBE
        self.coordinates = {
            name: vector if cube else hemisphere_maps.coordinates(vector) for name, vector in vectors.items()
        }
        self.lit = cosine[:, None] * loaded.color if lit else np.ones((len(cosine), 3))

    def draw(self, label, lookups=(), colors=None, combiners=None, blending=None, first=False):
        """One pass; each lookup is a unit with a coordinate set of its own."""
        environment = {} if combiners else {"environment": MODULATE}
        units = [unit(lookup.texture, EDGE, coordinates=k, **environment) for k, lookup in enumerate(lookups)]
        mesh = self.surface.mesh(*(self.coordinates[each.along] for each in lookups), colors=colors)
        self.out.append(
            draw(
                label,
                mesh,
                self.view,
                combiners,
                units,
                depth_test=FIRST_PASS if first else LATER_PASS,
                blending=blending,
            )
        )

    def multiplied(self, each, first, blending=None):
        """A product of textures without signs, in as many draws as the units need; the last has n.l."""
        units = self.loaded.board.units
        parts = [each.lookups[k : k + units] for k in range(0, len(each.lookups), units)]
        for k, lookups in enumerate(parts):
            last = k == len(parts) - 1
            words = " ".join(lookup.texture for lookup in lookups)
            self.draw(
                f"{'times ' if k else ''}{words}{' n.l' if last else ''}",
                lookups,
                self.lit if last else None,
                blending=MULTIPLY_DESTINATION if k else blending,
                first=first and k == 0,
            )

    def blended(self):
        """Each product a draw that adds or subtracts; only a first one may take several."""
        subtracts, inverted = self.loaded.board.subtracts, False
        for k, each in enumerate(self.loaded.products):
            if each.sign > 0:
                self.multiplied(each, k == 0, ADD if k else None)
            elif subtracts:
                self.multiplied(each, False, SUBTRACT)
            else:
                if not inverted:
                    self.draw("one minus that", blending=INVERT_DESTINATION)
                    inverted = True
                self.multiplied(each, False, ADD)
        if inverted:
            self.at_most_one("one minus that is not below zero")
            self.draw("one minus that", blending=INVERT_DESTINATION)
        self.at_most_one("(.)+: the framebuffer does not fall below zero")
        for _ in range(round(math.log2(self.loaded.boost))):
            self.draw("twice that", blending=_DOUBLE)

    def at_most_one(self, label):
        """Colours are in [0, 1] from here on."""
        if len(self.loaded.products) > 1:
            self.out.append(Saturate(label=label, scissor=self.view.panel.scissor))

    def combined(self):
        """Terms in a combiner, two where there are four units: the positive parts of all sums, then the
        negative parts, for what was taken off below zero would be lost.
        """
        together, products = self.loaded.board.together, self.loaded.products
        groups = [products[k : k + together] for k in range(0, len(products), together)]
        for sign, blending in ((1, ADD), (-1, SUBTRACT)):
            for k, group in enumerate(groups):
                if sign < 0 and not any(each.stored_signed for each in group):
                    continue
                first = sign > 0 and k == 0
                lookups = tuple(lookup for each in group for lookup in each.lookups)
                words = " plus ".join(" ".join(lookup.texture for lookup in each.lookups) for each in group)
                self.draw(
                    f"{'minus ' if sign < 0 else ''}({words}) n.l",
                    lookups,
                    self.lit,
                    self.combiners(group, sign),
                    None if first else blending,
                    first=first,
                )
        self.at_most_one("(.)+: the framebuffer does not fall below zero")

    def combiners(self, group, sign):
        """(sign times the sum of a group's products)+ times the colour, times the boost."""
        terms = []
        for k, each in enumerate(group):
            a, b = _TEXTURES[2 * k : 2 * k + 2]
            if each.stored_signed:
                a, b = expand(a), expand(b)
            terms.append(product(a if sign > 0 else negated(a), b))
        times = product(signed(SPARE0), PRIMARY, SPARE0)
        return program(total(*terms, to=SPARE0), scaled(self.loaded.boost, times), shown(SPARE0))

    def accumulated(self):
        """Each product in the window, which is black but for it; the sum is in the accumulation buffer, with
        what was behind the surface.
        """
        scissor = self.view.panel.scissor
        black = np.zeros_like(self.lit)
        self.draw("depths", colors=black, first=True)

        def accumulate(label, operation, value):
            self.out.append(Accum(label=label, operation=operation, value=value, scissor=scissor))

        accumulate("keep what is behind", AccumOperation.LOAD, 1.0)
        for each in self.loaded.products:
            self.out.append(Clear(label="clear colour", color=(0.0, 0.0, 0.0, 0.0), scissor=scissor))
            self.multiplied(each, False)
            label = "add it" if each.sign > 0 else "take it off"
            accumulate(label, AccumOperation.ACCUM, each.sign * self.loaded.boost)
        accumulate("return the sum", AccumOperation.RETURN, 1.0)


def passes(surface, loaded, view, light, *, lit=True):
    """Commands that draw a surface with LoadedFactors over the window's contents. The surface need not be
    drawn before. pi f_r (n.l)+ times the intensity.

    surface  a Surface, whose tangents are the reflectance's first axis
    light    a ``views.Light``, directional or a point
    lit      False: the products alone, without n.l and their scale, as the textures hold them
    """
    out = _Passes(surface, loaded, view, light, lit)
    one_product = len(loaded.products) == 1
    if loaded.board.means is Means.COMBINERS and len(loaded.products[0].lookups) == 2:
        out.combined()
    elif loaded.board.means is Means.ACCUMULATION and not (one_product and loaded.boost == 1.0):
        out.accumulated()
    else:
        out.blended()
    return tuple(out.out)
