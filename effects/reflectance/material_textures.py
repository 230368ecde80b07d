"""K21, material textures: a surface's reflection per texel, in the form that the combiners read.

An author gives a local frame and the parameters of the anisotropic Blinn-Phong model per texel. The textures
hold the tangent divided by alpha_x and the binormal divided by alpha_y. Both are scaled by 0.25, so that
components stay in [-1, 1] for alpha >= 0.25, and encoded for EXPAND_NORMAL. Their alphas hold k_s and N/128.

Source: Kautz, Seidel 2000, sections 3.2, 4 and 4.1: N and k_s go into the textures' alpha channels (K21 of
the catalogue; limits: its artefact P10; which alpha holds which: its section on material textures).
"""

import warnings
from collections import deque
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.height_fields import (
    frames,
    gradient_noise,
    slopes,
    smooth,
    texel_centers,
    turbulence,
    value_noise,
)
from fixedpipe.effects.geometry.vectors import cosine, cross, dot, normalize, sine
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.encoding import factor_texels, vector_and_factor_texels
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture, texture_2d
from fixedpipe.pipeline.textures.pixels import unit_numbers

TECHNIQUES = (Technique("K21", "material textures: scratches, brushed metal, gold, marble", "4.1, 6"),)

# The machine multiplies by four after the dot product, so the textures hold a quarter.
STORAGE_SCALE = 0.25
# With this scale a vector divided by alpha fits [-1, 1] only for alpha >= 0.25.
SMALLEST_ALPHA = 0.25
# The exponent N is stored as a fraction of the largest that OpenGL's own lighting has (GL_SHININESS).
LARGEST_EXPONENT = 128.0


@dataclass(frozen=True, eq=False)
class Material:
    """Local frame and reflectance per texel, bottom row first.

    normals, tangents, binormals  float64 [rows, columns, 3], orthonormal, in the surface's frame (t, b, n)
    alpha_x, alpha_y              float64 [rows, columns], in (0, 1]: the smaller, the narrower along t or b
    k_s                           float64 [rows, columns], in [0, 1]
    exponent                      float64 [rows, columns], in [1, 128]: N of the model with a square root and
                                  a power; 2 is Eq. 1 (erratum E004.4)
    """

    normals: np.ndarray
    tangents: np.ndarray
    binormals: np.ndarray
    alpha_x: np.ndarray
    alpha_y: np.ndarray
    k_s: np.ndarray
    exponent: np.ndarray | float = 2.0

    def __post_init__(self):
        for name in ("normals", "tangents", "binormals"):
            vectors, shape = unit_numbers(getattr(self, name), f"The array of {name}"), np.shape(self.normals)
            object.__setattr__(self, name, vectors)
            if vectors.shape != shape or vectors.ndim != 3 or shape[2] != 3 or not vectors.size:
                raise ValueError(
                    f"The {name} have shape {vectors.shape}; give all three vectors as [rows, columns, 3]."
                )
        shape = self.normals.shape[:2]
        for name in ("alpha_x", "alpha_y", "k_s", "exponent"):
            value = np.asarray(getattr(self, name))
            if value.dtype.kind not in "biuf":
                raise ValueError(f"{name} holds {value.dtype}; give numbers.")
            value = value.astype(np.float64)
            object.__setattr__(self, name, np.ascontiguousarray(np.broadcast_to(value, shape)))
        for name in ("alpha_x", "alpha_y"):
            value = getattr(self, name)
            if not (value > 0.0).all() or not (value <= 1.0).all():
                raise ValueError(
                    f"{name} ranges over {value.min():g}..{value.max():g}; give values greater than 0 and at "
                    "most 1."
                )
        if not (self.k_s >= 0.0).all() or not (self.k_s <= 1.0).all():
            raise ValueError(
                f"k_s ranges over {self.k_s.min():g}..{self.k_s.max():g}; give values from 0 to 1: / 255.0 "
                "if they are bytes."
            )
        if not (self.exponent >= 1.0).all() or not (self.exponent <= LARGEST_EXPONENT).all():
            raise ValueError(
                f"The exponent ranges over {self.exponent.min():g}..{self.exponent.max():g}; give values "
                f"from 1 to {LARGEST_EXPONENT:g}."
            )

    @property
    def scaled_tangents(self):
        """T / alpha_x with the alpha that the storage allows: what Eq. 1 takes."""
        return self.tangents / np.maximum(self.alpha_x, SMALLEST_ALPHA)[..., None]

    @property
    def scaled_binormals(self):
        """B / alpha_y with the alpha that the storage allows."""
        return self.binormals / np.maximum(self.alpha_y, SMALLEST_ALPHA)[..., None]

    def tangent_texture(self, profile):
        """T': RGB = t / (4 alpha_x) for EXPAND_NORMAL, alpha = k_s."""
        return texture_2d(vector_and_factor_texels(STORAGE_SCALE * self.scaled_tangents, self.k_s, profile))

    def binormal_texture(self, profile):
        """B': RGB = b / (4 alpha_y) for EXPAND_NORMAL, alpha = N / 128."""
        stored = self.exponent / LARGEST_EXPONENT
        return texture_2d(vector_and_factor_texels(STORAGE_SCALE * self.scaled_binormals, stored, profile))

    def normal_texture(self, profile):
        """The normal map: RGB = n for EXPAND_NORMAL, alpha = k_s, which serves as gloss map."""
        return texture_2d(vector_and_factor_texels(self.normals, self.k_s, profile))


@dataclass(frozen=True)
class MaterialNames:
    """The names of a material's three texture objects."""

    normal: str
    tangent: str
    binormal: str


class StoredAlpha(UserWarning):
    """An alpha of a material is less than its textures can hold, so a wider highlight is drawn."""


# The textures that were made last: material, which of them, machine, texture. Whoever moves a light loads the
# same ones for every picture; a figure has at most four materials.
_MADE: deque[tuple[Material, str, Profile, Texture]] = deque(maxlen=12)


def _texture(material, which, profile):
    """A Material's texture, "normal", "tangent" or "binormal", for a machine."""
    for of, what, machine, texture in tuple(_MADE):
        if of is material and what == which and (machine is profile or machine == profile):
            return texture
    texture = getattr(material, f"{which}_texture")(profile)
    _MADE.append((material, which, profile, texture))
    return texture


def load_normals(material, name, profile):
    """The command that loads the normal map alone, and the texture's name."""
    normal = f"{name} n"
    image = _texture(material, "normal", profile)
    return TexImage(label=f"load normal map of {name}", texture=normal, image=image), normal


def load(material, name, profile):
    """Commands that load the three material textures once, and their names.

    Warns of StoredAlpha where an alpha is less than SMALLEST_ALPHA, which is stored in its place.
    """
    least = float(min(material.alpha_x.min(), material.alpha_y.min()))
    if least < SMALLEST_ALPHA:
        warnings.warn(
            f"The textures of {name} hold alphas of {SMALLEST_ALPHA:g} and more, so {least:g} is drawn as "
            f"{SMALLEST_ALPHA:g}. Give a larger alpha, or a machine with the imaging subset, as OCTANE.",
            StoredAlpha,
            stacklevel=2,
        )
    normal_map, normal = load_normals(material, name, profile)
    names = MaterialNames(normal, f"{name} t/ax", f"{name} b/ay")
    commands = (
        normal_map,
        TexImage(
            label=f"load material texture of {name}: tangent / (4 alpha_x), k_s",
            texture=names.tangent,
            image=_texture(material, "tangent", profile),
        ),
        TexImage(
            label=f"load material texture of {name}: binormal / (4 alpha_y), N / 128",
            texture=names.binormal,
            image=_texture(material, "binormal", profile),
        ),
    )
    return commands, names


def load_colors(colors, name, profile):
    """The command that loads a colour map: RGB in [0, 1], float64 [rows, columns, 3], texture ``name``."""
    return TexImage(label=f"load {name}", texture=name, image=texture_2d(factor_texels(colors, profile)))


def from_slopes(slope_s, slope_t, alpha_x, alpha_y, k_s=1.0):
    """A bumpy surface whose tangents follow s: normals, tangents and binormals from a height field's
    slopes.
    """
    return Material(*frames(slope_s, slope_t), alpha_x, alpha_y, k_s)


def _turned(angles, slope_s, slope_t, alpha_x, alpha_y, k_s):
    """Tangents at ``angles`` (radians from the s axis) laid on the slopes."""
    normals, _, _ = frames(slope_s, slope_t)
    flat = np.stack([cosine(angles), sine(angles), np.zeros(angles.shape)], axis=-1)
    tangents = normalize(flat - dot(flat, normals)[..., None] * normals)
    return Material(normals, tangents, cross(normals, tangents), alpha_x, alpha_y, k_s)


def isotropic(columns, rows, alpha, k_s=1.0):
    """A smooth surface with alpha_x = alpha_y."""
    zero = np.zeros((rows, columns))
    return from_slopes(zero, zero, alpha, alpha, k_s)


class Brushing(Enum):
    """Which of a texture's coordinates strokes run along."""

    ALONG_S = "s"
    ALONG_T = "t"


def _strokes(columns, rows, brushing, cells, seed):
    """Noise in [-1, 1] of strokes, one texel wide and 1/``cells`` of the texture long.

    Rounded to multiples of 1/256.
    """
    along_s = member_of(Brushing, brushing, "The brushing") is Brushing.ALONG_S
    size = (columns, rows) if along_s else (rows, columns)
    # As many lattice cells across the strokes as texels: every row of texels is a row of strokes.
    noise = value_noise(*size, cells, size[1], seed)
    noise = np.floor(noise * 256.0 + 0.5) / 256.0
    return noise if along_s else noise.T


def _read_only(material):
    for array in vars(material).values():
        array.setflags(write=False)
    return material


@lru_cache(maxsize=2)
def brushed(columns, rows, brushing, *, alpha_x, alpha_y, spread, depth=0.0, k_s=(0.7, 1.0), seed=1):
    """A brushed surface: tangents follow the strokes within +-``spread`` degrees.

    ``depth``: the largest slope across the strokes. ``k_s``: its range over the strokes. Strokes are one
    texel wide and a sixteenth of the texture long. Every amount is a multiple of 1/256 of its range. The last
    two are cached, because a figure is drawn by a machine and by the ideal: arrays are read-only.
    """
    angles = np.radians(spread * _strokes(columns, rows, brushing, 16, seed))
    angles = angles + (0.0 if brushing is Brushing.ALONG_S else np.pi / 2)
    across = depth * _strokes(columns, rows, brushing, 16, seed + 1)
    zero = np.zeros(across.shape)
    slope = (zero, across) if brushing is Brushing.ALONG_S else (across, zero)
    gloss = k_s[0] + (k_s[1] - k_s[0]) * (0.5 + 0.5 * _strokes(columns, rows, brushing, 24, seed + 2))
    return _read_only(_turned(angles, *slope, alpha_x, alpha_y, gloss))


def brushed_bumps(slope_s, slope_t, *, alpha_x, alpha_y, spread, stroke_depth, k_s, seed=3):
    """Strokes along s laid over a bumpy surface, given by its slopes, float64 [rows, columns].

    spread        degrees by which the tangents of the strokes leave the s axis at most
    stroke_depth  the largest slope across the strokes
    k_s           its lowest and highest value over the strokes

    Strokes are one texel wide and about an eighth of the texture long; their amounts are multiples of 1/256.
    """
    rows, columns = slope_s.shape
    angles = np.radians(spread * _strokes(columns, rows, Brushing.ALONG_S, 8, seed + 4))
    across = slope_t + stroke_depth * _strokes(columns, rows, Brushing.ALONG_S, 8, seed + 3)
    gloss = k_s[0] + (k_s[1] - k_s[0]) * (0.5 + 0.5 * _strokes(columns, rows, Brushing.ALONG_S, 12, seed + 5))
    return _turned(angles, slope_s, across, alpha_x, alpha_y, gloss)


@lru_cache(maxsize=2)
def gold(size, *, bumps, depth, seed=3, **strokes):
    """Slightly brushed, bumpy metal, ``size`` x ``size`` texels: rounded bumps under strokes along s.

    ``bumps``: about how many along an edge of the texture. ``depth``: the largest slope of the bumps, about.
    ``strokes``: the other keywords of ``brushed_bumps``.
    """
    # Assumed: gradient noise of amplitude one climbs by three per cell at most; a test holds the slopes.
    heights = gradient_noise(*texel_centers(size, size), bumps, seed) * (depth / (3.0 * bumps))
    return _read_only(brushed_bumps(*slopes(smooth(heights)), seed=seed, **strokes))


@dataclass(frozen=True, eq=False)
class Marble:
    """A marble's material, its colour map and where it is dark.

    colors    float64 [rows, columns, 3], RGB in [0, 1]
    darkness  float64 [rows, columns]: 0 in the light stone, 1 in the middle of the veins
    """

    material: Material
    colors: np.ndarray
    darkness: np.ndarray


@lru_cache(maxsize=8)
def marble(size, *, cells, width, relief, alpha_x, alpha_y, k_s, light_color, dark_color, seed=11):
    """Light marble with elevated dark veins, ``size`` x ``size`` texels.

    Veins lie where noise of several sizes, itself displaced by other noise, passes through zero.

    cells    about how many veins cross an edge of the texture
    width    of the veins from their middle, in texels, about
    relief   how high the veins stand, in texels
    alpha_y  in the light stone and in the veins: where it is larger the highlight covers more, so the dark
             parts reflect more
    light_color, dark_color
             RGB in [0, 1] of the stone and of the veins
    """
    s, t = texel_centers(size, size)
    u = s + turbulence(s, t, cells, 3, seed) * (0.6 / cells)
    v = t + turbulence(s, t, cells, 3, seed + 10) * (0.6 / cells)
    veins = np.zeros((size, size))
    # Wide veins, and thinner and fainter ones between them.
    for finer, strength in ((1, 1.0), (2, 0.7)):
        noise = turbulence(u, v, cells * finer, 3, seed + 20 * finer)
        climb_s, climb_t = slopes(noise)
        # Noise over its own slope is the distance to where it is zero; where it is flat, it never comes near.
        distance = np.abs(noise) / np.sqrt(climb_s * climb_s + climb_t * climb_t + cells * cells)
        swell = 0.6 + turbulence(t, s, 2 * cells, 2, seed + 40 * finer)
        edge = np.maximum(0.0, 1.0 - distance * size / np.maximum(width / finer * swell, 2.5))
        # A cubic that is level at the foot and at the top.
        veins = np.maximum(veins, strength * (edge * edge * (3.0 - 2.0 * edge)))
    clouds = 0.5 + turbulence(v, u, cells, 4, seed + 60)
    darkness = np.floor(veins * 256.0 + 0.5) / 256.0
    tone = np.maximum(darkness, 0.3 * np.maximum(clouds, 0.0))[..., None]
    colors = np.array(light_color) * (1.0 - tone) + np.array(dark_color) * tone
    slope_s, slope_t = slopes(smooth(darkness) * (relief / size))
    material = from_slopes(slope_s, slope_t, alpha_x, alpha_y[0] + (alpha_y[1] - alpha_y[0]) * darkness, k_s)
    return Marble(_read_only(material), colors, darkness)


@dataclass(frozen=True, eq=False)
class ScratchedMaterial:
    """A scratched material and where its scratches are.

    ``along_s``, ``along_t``: bool [rows, columns]: the texels of the scratches along either axis, crossings
    in neither. ``scratched``: the texels of any scratch.
    """

    material: Material
    along_s: np.ndarray
    along_t: np.ndarray
    scratched: np.ndarray


def scratched(size, count, *, alpha_x, alpha_y, alpha, k_s, k_s_scratch, slope, seed):
    """A square of isotropic ``alpha`` and ``k_s`` with ``count`` straight scratches along each axis.

    A scratch is a groove two texels wide whose sides slope by ``slope``; its tangents run along it, with
    alpha_x and alpha_y. Where two scratches cross, the surface reflects widely along both: alpha_x = alpha_y
    = ``alpha_y``.
    ``k_s_scratch``: lowest and highest k_s of a scratch. Positions, lengths and k_s come from seeded
    integers.
    """
    random = np.random.Generator(np.random.PCG64(seed))
    on = np.zeros((2, size, size), bool)
    side_slopes, gloss = np.zeros((2, size, size)), np.full((size, size), float(k_s))
    for k in range(2 * count):
        length = int(random.integers(size // 5, size))
        start = int(random.integers(-size // 8, size - length // 2))
        row = int(random.integers(2, size - 3))
        brightness = k_s_scratch[0] + (k_s_scratch[1] - k_s_scratch[0]) * int(random.integers(0, 17)) / 16.0
        run = slice(max(start, 0), min(start + length, size))
        for side in (0, 1):
            at = (row + side, run) if k % 2 == 0 else (run, row + side)
            on[k % 2][at] = True
            side_slopes[k % 2][at] = (2 * side - 1) * slope
            gloss[at] = np.maximum(gloss[at], brightness)
    crossing = on[0] & on[1]
    along_s, along_t = on[0] & ~crossing, on[1] & ~crossing
    material = _turned(
        np.where(along_t, np.pi / 2, 0.0),
        np.where(along_t, side_slopes[1], 0.0),
        np.where(along_s, side_slopes[0], 0.0),
        np.where(crossing, alpha_y, np.where(along_s | along_t, alpha_x, alpha)),
        np.where(on.any(axis=0), alpha_y, alpha),
        gloss,
    )
    return ScratchedMaterial(material, along_s, along_t, on.any(axis=0))
