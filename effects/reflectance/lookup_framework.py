"""K01, the framework of the paper's figure 1, run as an effect.

Material textures feed a parameter stage; dependent lookups of sampled functions follow; their results are
combined.

The figure's functions are F(s, t) = exp(s/t) and G(u, v) = sqrt(u^v). s, t and u are dot products, and v is
read from a material texture. This module draws their product. The figure leaves open, and the project chose:

- s = -(a.l)+ with a direction a per texel, t = (n.e)+, u = (n.l)+ with the normal n, the light l and the eye
  e; v in [0, 8]. The quotient is negative, as in Ward's E(m, d) = exp(-2m / (1 + d)), so exp(s/t) <= 1 and
  needs no scale: the table's first coordinate is -s.
- The tables cover [0, 1] x [0, 1] with 256 x 256 texels; the second coordinate of G is v/8. Where s = t = 0
  the quotient is taken as zero.

The texture of a holds a in RGB; the texture of n holds n, and v/8 in alpha.

Source: Kautz, Seidel 2000, section 3, figure 1 (K01 of the catalogue; its figure F004-1).
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.geometry import height_fields, vectors
from fixedpipe.effects.geometry.vectors import cosine, normalize, sine
from fixedpipe.effects.geometry.vertex_vectors import light_vectors, view_vectors
from fixedpipe.effects.passes import pixel_texture_copies, software_pixel_texture
from fixedpipe.effects.passes.arguments import one_of
from fixedpipe.effects.passes.combiners import PRIMARY, SPARE0, TEXTURE0, dot, expand, program, shown
from fixedpipe.effects.passes.draws import (
    FIRST_PASS,
    MARK,
    MARKED,
    MULTIPLY_DESTINATION,
    REPEATED,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_and_factor_texels, vector_colors
from fixedpipe.effects.reflectance.sampled_functions import sampled
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import HostStep, TexImage
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (Technique("K01", "the framework: material textures, dot products, functions looked up", "3"),)

TABLE_TEXELS = 256
LARGEST_V = 8.0


def exponential(minus_s, t):
    """F(s, t) = exp(s/t) of -s and t in [0, 1]."""
    return np.exp(-np.asarray(minus_s) / np.maximum(t, 1e-30))


def root_of_power(u, eighth_of_v):
    """G(u, v) = sqrt(u^v) of u and v/8 in [0, 1]."""
    return np.sqrt(np.asarray(u) ** (LARGEST_V * np.asarray(eighth_of_v)))


def exponential_table(profile, bits=8):
    """F's texture: -s along its columns, t along its rows."""
    return sampled(exponential, TABLE_TEXELS, TABLE_TEXELS, profile=profile, bits=bits)


def power_table(profile, bits=8):
    """G's texture: u along its columns, v/8 along its rows."""
    return sampled(root_of_power, TABLE_TEXELS, TABLE_TEXELS, profile=profile, bits=bits)


@dataclass(frozen=True, eq=False)
class Textures:
    """The figure's material textures, bottom row first, in the surface's frame.

    directions   a, float64 [rows, columns, 3] of length one
    normals      n, the same
    eighths      v/8, float64 [rows, columns], in [0, 1]
    """

    directions: np.ndarray
    normals: np.ndarray
    eighths: np.ndarray

    def parameters(self, toward_light, toward_eye):
        """(-s, t, u, v/8) at every texel, float64 [rows, columns] each; vectors in the surface's frame."""
        return (
            np.maximum(vectors.dot(self.directions, toward_light), 0.0),
            np.maximum(vectors.dot(self.normals, toward_eye), 0.0),
            np.maximum(vectors.dot(self.normals, toward_light), 0.0),
            self.eighths,
        )

    def evaluated(self, toward_light, toward_eye):
        """F(s, t) G(u, v) at every texel in float64: what no machine's table has a part in."""
        minus_s, t, u, eighth = self.parameters(toward_light, toward_eye)
        return exponential(minus_s, t) * root_of_power(u, eighth)


def load_tables(profile, bits=8):
    """The commands that load the sampled functions as the textures "F" and "G"."""
    return (
        TexImage(label="load F(s, t) = exp(s/t)", texture="F", image=exponential_table(profile, bits)),
        TexImage(label="load G(u, v) = sqrt(u^v)", texture="G", image=power_table(profile, bits)),
    )


def load_textures(textures, profile):
    """The commands that load the material textures as "a" and "n", vectors as EXPAND_NORMAL reads them."""
    a = texture_2d(vector_and_factor_texels(textures.directions, 1.0, profile))
    n = texture_2d(vector_and_factor_texels(textures.normals, textures.eighths, profile))
    return (
        TexImage(label="load material texture: a", texture="a", image=a),
        TexImage(label="load material texture: n, v/8", texture="n", image=n),
    )


def woven_domes(size, *, bumps=4, height=0.6, cells=16, tilt=0.25, spread=10.0, seed=4):
    """Material textures of one square: domes on a weave, and an exponent that grows from left to right.

    There are ``bumps`` domes along each edge, with their slopes times ``height``. The weave has ``cells``
    cells along each edge. In them a runs at 35 and at 125 degrees in turn, varied by ``spread``, and leans
    out of the surface by ``tilt``. v/8 is in multiples of 1/256.
    """
    s, t = height_fields.texel_centers(size, size)
    slope_s, slope_t = height_fields.dome_slopes(s * bumps, t * bumps)
    normals, _, _ = height_fields.frames(height * slope_s, height * slope_t)
    crossing = (np.floor(s * cells) + np.floor(t * cells)) % 2
    noise = height_fields.value_noise(size, size, 2 * cells, 2 * cells, seed)
    angle = np.radians(35.0 + 90.0 * crossing + spread * noise)
    directions = normalize(np.stack([cosine(angle), sine(angle), np.full(s.shape, tilt)], axis=-1))
    eighths = np.floor(256.0 * s + 0.5) / 256.0
    return Textures(directions, normals, eighths)


# ---------------------------------------------------------------------------- by pixel textures (Octane)

_CHANNELS = (
    pixel_texture_copies.FROM_RED,
    pixel_texture_copies.FROM_GREEN,
    pixel_texture_copies.FROM_BLUE,
    pixel_texture_copies.FROM_ALPHA,
)
RESULT = "F(s, t) G(u, v)"
STAGES = ("s", "t", "u", "v", "F(s, t)", "G(u, v)", RESULT)


def parameters_by_color_matrix(surface, textures, view, light, profile, *, bits=8, sampler=REPEATED):
    """The parameter stage on the Octane: -s, t, u and v/8 in red, green, blue and alpha, in two passes.

    ``surface`` flat, ``view`` of an infinite viewer, ``light`` directional, as in ``pixel_textures``.
    """
    toward_light = pixel_texture_copies.flat_vector(light_vectors(surface, light), "light vector")
    toward_eye = pixel_texture_copies.flat_vector(view_vectors(surface, view), "viewing vector")
    dot_with, nothing = pixel_texture_copies.dot_with, pixel_texture_copies.NOTHING
    drawn = {"surface": surface, "view": view, "sampler": sampler}
    return (
        pixel_texture_copies.begin(view),
        pixel_texture_copies.load_products(
            "load a through l",
            "a",
            textures.directions,
            [dot_with(toward_light), nothing, nothing, nothing],
            profile,
            bits,
        ),
        pixel_texture_copies.polygon(
            "-s = (a.l)+ to red", texture="a", first=True, mask=pixel_texture_copies.RED, **drawn
        ),
        pixel_texture_copies.load_products(
            "load n through e and l, v/8 as it is",
            "n",
            textures.normals,
            [nothing, dot_with(toward_eye), dot_with(toward_light), pixel_texture_copies.FROM_ALPHA],
            profile,
            bits,
            alpha=textures.eighths,
        ),
        pixel_texture_copies.polygon(
            "t = (n.e)+ to green, u = (n.l)+ to blue, v/8 to alpha",
            texture="n",
            mask=pixel_texture_copies.NOT_RED,
            **drawn,
        ),
    )


def by_pixel_textures(surface, textures, view, light, profile, *, stage=RESULT, bits=8, sampler=REPEATED):
    """The whole of the figure on the Octane, as far as ``stage``, one of ``STAGES``, and that shown in grey.

    Both lookups and their product are two copies; a third shows the result in red, green and blue.
    """
    one_of(STAGES, stage, "The stage")
    red = pixel_texture_copies.RED
    look_up_f = pixel_texture_copies.looked_up("look up F(s, t), to red", view, "F", *_CHANNELS[:2], mask=red)
    times_g = pixel_texture_copies.looked_up(
        "look up G(u, v), times red", view, "G", *_CHANNELS[2:], mask=red, blending=MULTIPLY_DESTINATION
    )
    g_alone = pixel_texture_copies.looked_up("look up G(u, v), to red", view, "G", *_CHANNELS[2:], mask=red)
    lookups = {STAGES[4]: (look_up_f,), STAGES[5]: (g_alone,), RESULT: (look_up_f, times_g)}
    channel = _CHANNELS[STAGES.index(stage)] if stage in STAGES[:4] else _CHANNELS[0]
    return (
        *parameters_by_color_matrix(surface, textures, view, light, profile, bits=bits, sampler=sampler),
        *lookups.get(stage, ()),
        pixel_texture_copies.copied(f"{stage} in grey", view, (channel,) * 3, profile),
    )


# ------------------------------------------------------------------------- by the host (register combiners)


def _dot_product():
    """Combiners: (texture . primary colour)+ in red, green and blue, and the texel's alpha."""
    return program(dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0), shown(SPARE0, alpha=TEXTURE0))


def parameters_by_combiners(surface, view, light, profile, *, sampler=REPEATED):
    """The parameter stage on register combiners: -s, t, u and v/8 in red, green, blue and alpha, in three
    passes over the textures "a" and "n" (``load_textures``). Vectors are vertex colours: surfaces may be
    curved, lights and viewers near.
    """

    def dot_product(label, toward, texture, mask, **settings):
        mesh = surface.mesh(colors=vector_colors(toward, profile))
        units = (unit(texture, sampler),)
        return draw(label, mesh, view, _dot_product(), units, color_mask=mask, **settings)

    toward_light, toward_eye = light_vectors(surface, light), view_vectors(surface, view)
    first = {"depth_test": FIRST_PASS, "stencil_test": MARK}
    return (
        pixel_texture_copies.begin(view),
        dot_product("-s = (a.l)+ to red", toward_light, "a", pixel_texture_copies.RED, **first),
        dot_product("t = (n.e)+ to green", toward_eye, "n", pixel_texture_copies.GREEN),
        dot_product("u = (n.l)+ to blue, v/8 to alpha", toward_light, "n", pixel_texture_copies.BLUE_ALPHA),
    )


def by_host(surface, view, light, profile, *, stage=RESULT, sampler=REPEATED):
    """The whole of the figure on a board without dependent lookups, as far as ``stage``, one of ``STAGES``,
    and that shown in grey: the host reads the parameters once, looks up F and G (``software_pixel_texture``)
    and draws what it found; G(u, v) is multiplied by blending.
    """
    one_of(STAGES, stage, "The stage")
    panel = view.panel
    place = {"x": panel.x, "y": panel.y}
    name = f"s, t, u, v from ({panel.x}, {panel.y}) on"
    tables = {"F(s, t)": exponential_table(profile), "G(u, v)": power_table(profile)}
    channels = {"F(s, t)": (0, 1), "G(u, v)": (2, 3)}

    def looked_up(pixels):
        read = pixels[name]
        one = 255 if read.dtype == np.uint8 else 1.0
        if stage in STAGES[:4]:
            grey = np.full_like(read, one)
            grey[..., :3] = read[..., STAGES.index(stage), None]
            state = PassState(stencil_test=MARKED)
            return (software_pixel_texture.drawn(f"{stage} in grey", grey, state=state, **place),)
        commands = ()
        for function in ("F(s, t)", "G(u, v)") if stage == RESULT else (stage,):
            coordinates = np.full_like(read, one)
            coordinates[..., :2] = read[..., list(channels[function])]
            found = software_pixel_texture.look_up(coordinates, tables[function])
            times = MULTIPLY_DESTINATION if commands else None
            label = f"times {function}" if commands else function
            state = PassState(stencil_test=MARKED, blending=times)
            commands += (software_pixel_texture.drawn(label, found, state=state, **place),)
        return commands

    size = {"width": panel.width, "height": panel.height}
    return (
        *parameters_by_combiners(surface, view, light, profile, sampler=sampler),
        software_pixel_texture.read_back(name, **place, **size),
        HostStep(label=f"the host: {stage}", reads=(name,), commands=looked_up),
    )
