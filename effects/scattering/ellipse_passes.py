"""G15 and G16: shadows of bumps on a board, by the ellipses of the module ``ellipses``.

The test is Eq. 4, 1 - (E1.l)^2 - (E2.l)^2 with l = (l_x, l_y, 1) in the frame of the surface without its
bumps (erratum E002.9). Its result is a mark in the stencil buffer; light is added to marked pixels:

1. Ambient light everywhere; the depths.
2. The mark.
3. Bump mapping where the mark is.

The ambient light comes first, not last. A slope in shadow leaves no mark, and no depth where the alpha test
refuses its fragments. A lit slope behind it would shine through.

Register combiners (G15): E1 in unit 0, E2 in unit 1, both stored as quarters, or as halves if no number is
above two; l at the vertices in the primary colour. The first general combiner computes both products times
four, or two. The second adds their squares, and the final one subtracts the sum from one. The alpha test is
GREATER 0. Numbers that saturate at one are outside the ellipse anyway.

The imaging subset (G16) has one l for the surface. While the image is loaded, a colour matrix computes the
products and a table squares them. Two draws add the squares, and a white draw subtracts them from one. Then
the framebuffer is copied onto itself with red as alpha. The alpha test passes fragments with alpha above
zero, and they leave marks.

Combiners filter the pair of forms; the imaging subset filters their squares. For combiners, the signs of
neighbours must agree (``ellipses.rooted``; erratum E002.15).

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 4; Heidrich 2001, section 3.1; pass sequences A-G15,
A-G16, A-G35.
"""

from dataclasses import replace
from functools import cache

import numpy as np

from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.geometry.vertex_vectors import light_vectors
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.combiners import (
    ONE,
    PRIMARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    blue_of,
    both,
    constant_product,
    dot,
    expand,
    final,
    one_minus,
    program,
    scaled,
    signed,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    FIRST_PASS,
    LATER_PASS,
    MARK,
    MARKED,
    MULTIPLY_DESTINATION,
    REPEATED,
    REPLACE,
    SUBTRACT_FROM_SOURCE,
    copy_of_panel,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_colors, vector_texels
from fixedpipe.effects.passes.host_images import HostImage, dot_product_transfer
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.commands import Clear, TexImage
from fixedpipe.pipeline.enums import BaseFormat, ComparisonFunction, InternalFormat
from fixedpipe.pipeline.pixel_transfer import PixelImage, PixelTransfer
from fixedpipe.pipeline.state import AlphaTest, ColorMask, ColorTable, PassState
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("G15", "the test whether light lies in an ellipse, by register combiners", "4, Eqs. 2-4"),
    Technique("G16", "the test whether light lies in an ellipse, by the imaging subset", "4"),
    Technique("G35", "a terrain with the shadows of its bumps", "6"),
    Technique("H48", "the test whether light lies in an ellipse, by register combiners", "3.1"),
    Technique("H49", "the test whether light lies in an ellipse, by the imaging subset", "3.1"),
    Technique("H45", "bump mapping by a colour matrix: an image of normals loaded through l", "3"),
    Variant(("K10",), "by the imaging subset, where a mark is"),
)

POSITIVE_ALPHA = AlphaTest(ComparisonFunction.GREATER, 0.0)
NO_COLOR = ColorMask(False, False, False, False)
# Assumed: entries of a colour table; any machine with one holds so many. The exact machine has its longest.
TABLE_ENTRIES = 1024


def divisor(forms):
    """The divisor of the stored numbers of E1 and E2, 1, 2 or 4. A combiner's scale multiplies them back, and
    the smallest divisor has the finest steps.
    """
    largest = max(float(np.abs(form).max()) for form in forms)
    return next((scale for scale in (1, 2) if largest <= scale), 4)


def load(forms, profile, name="ellipses"):
    """The commands that load E1 and E2 for the combiners: ``forms``, a pair of float64 [rows, columns, 3] of
    -4 to 4, divided by their ``divisor``.
    """
    scale = float(divisor(forms))
    return tuple(
        TexImage(
            label=f"load E{k}/{scale:g} of the {name}",
            texture=f"{name}: E{k}",
            image=texture_2d(vector_texels(form / scale, profile)),
        )
        for k, form in enumerate(forms, 1)
    )


def test_combiners(scale=4):
    """1 - (E1.l)^2 - (E2.l)^2, at least zero, in colour and alpha: two general combiners."""
    first = dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0)
    second = dot(expand(TEXTURE1), expand(PRIMARY), to=SPARE1)
    return program(
        scaled(scale, both(first, second)),
        stage(total(square(signed(SPARE0)), square(signed(SPARE1)), to=SPARE0)),
        final(one_minus(SPARE0), alpha=one_minus(blue_of(SPARE0))),
    )


def clear_marks(view):
    """The command that takes all marks from the view's panel."""
    return Clear(label="clear the marks", stencil=0, scissor=view.panel.scissor)


def plane_light(surface, light):
    """l for the test at every vertex: (l_x, l_y, 1) in its frame, float64 [n, 3]."""
    vectors = light_vectors(surface, light).copy()
    vectors[:, 2] = 1.0
    return vectors


def marking_pass(surface, forms, view, light, profile, *, name="ellipses", sampler=REPEATED, **settings):
    """G15: the draw that marks where the light lies in the ellipse. ``forms``: as ``load`` had them;
    ``settings``: more of PassState.
    """
    mesh = surface.mesh(colors=vector_colors(plane_light(surface, light), profile))
    units = tuple(unit(f"{name}: E{k}", sampler) for k in (1, 2))
    settings = {"color_mask": NO_COLOR, "stencil_test": MARK, "alpha_test": POSITIVE_ALPHA} | settings
    return draw(
        "mark where l lies in the ellipse", mesh, view, test_combiners(divisor(forms)), units, **settings
    )


def _marked(commands):
    """The same draws, where the mark is."""
    return tuple(replace(c, state=replace(c.state, stencil_test=MARKED)) for c in commands)


def light_where_marked(
    surface, view, light, profile, mark, *,
    normal_map, color, ambient, color_map=None, sampler=REPEATED,
):  # fmt: skip
    """Ambient light, a draw that marks, and bump mapping where the marks are, by register combiners.

    surface           its frames are those of the surface without bumps
    light             a ``views.Light``
    mark              a Draw, ``marking_pass`` for instance; None: bump mapping everywhere
    normal_map        the name of a texture with normals for EXPAND_NORMAL
    color, ambient    RGB in [0, 1]
    color_map         the name of a texture by whose colours both are multiplied
    sampler           of the normal map and the colour map
    """
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    units = () if color_map is None else (unit(color_map, sampler),)
    everywhere = constant_product(ONE if color_map is None else TEXTURE0, ambient)
    lit = diffuse_bump.diffuse_pass(
        surface, normal_map, view, light, profile,
        color=color, color_map=color_map, depth_test=LATER_PASS, blending=ADD, sampler=sampler,
    )  # fmt: skip
    first = draw("ambient light", surface.mesh(), view, everywhere, units, depth_test=FIRST_PASS)
    return (first, *lit) if mark is None else (first, clear_marks(view), mark, *_marked(lit))


def combiner_passes(
    surface, forms, view, light, profile, *, name="ellipses", shadows=True, sampler=REPEATED, **settings
):
    """G15: ambient light, marks, and bump mapping where they are: three draws.

    forms     E1 and E2, as ``load`` had them under ``name``
    shadows   False: bump mapping everywhere, two draws
    sampler   of all textures
    settings  of ``light_where_marked``, as all other arguments are
    """
    mark = marking_pass(surface, forms, view, light, profile, name=name, sampler=sampler) if shadows else None
    return light_where_marked(surface, view, light, profile, mark, sampler=sampler, **settings)


# ------------------------------------------------------------------------------------- the imaging subset


def _one_light(surface, light):
    """l in the surface's frame, which has to be one for all of it: float64 [3]."""
    vectors = light_vectors(surface, light)
    if np.abs(vectors - vectors[0]).max() > 1e-9:
        raise ValueError(
            "The light's direction is another at each vertex, and a colour matrix has one for the whole "
            "surface; give a directional light and a surface whose frames are parallel."
        )
    return vectors[0]


def _entries(profile):
    return profile.pixels.max_color_table_size if profile.arithmetic.exact else TABLE_ENTRIES


@cache
def _squares(count):
    """d^2 of the products d = 2 i - 1 that a table's entries stand for."""
    products = 2.0 * (np.arange(count) / float(count - 1)) - 1.0
    return ColorTable(tuple((d * d, 0.0, 0.0, 0.0) for d in products.tolist()), BaseFormat.LUMINANCE)


@cache
def _positive(count, color):
    """The colour times (d)+."""
    products = np.maximum(0.0, 2.0 * (np.arange(count) / float(count - 1)) - 1.0)
    return ColorTable(tuple((*(c * d for c in color), 1.0) for d in products.tolist()))


def _load_products(label, texture, image, vector, table, internal_format):
    """The command that loads a HostImage as what a table makes of its products with a vector."""
    return TexImage(
        label=label,
        texture=texture,
        pixels=PixelImage(image.values, "RGB"),
        internal_format=internal_format,
        transfer=dot_product_transfer(vector, image.scale, table),
    )


def imaging_marking_passes(
    surface, forms, view, light, profile, *, name="ellipses", sampler=REPEATED, mark=True
):
    """G16: two loads and draws of squares, a white draw less their sum, and the copy that marks.

    forms  E1 and E2, float64 [rows, columns, 3], without bounds: the host stores floats
    mark   False: the test's value stays in the framebuffer, and the copy is left out

    The framebuffer's colours are overwritten, the depths written. Raises ValueError if the whole surface does
    not have one l.
    """
    x, y, _ = _one_light(surface, light)
    out = []
    for k, form in enumerate(forms, 1):
        texture = f"{name}: (E{k}.l)^2"
        image, table = HostImage.of(form, profile), _squares(_entries(profile))
        units = (unit(texture, sampler, environment=REPLACE),)
        settings = {"depth_test": FIRST_PASS} if k == 1 else {"blending": ADD}
        out += (
            _load_products(
                f"load (E{k}.l)^2 of the {name}",
                texture,
                image,
                (x, y, 1.0),
                table,
                InternalFormat.LUMINANCE8,
            ),
            draw(f"{'draw' if k == 1 else 'add'} (E{k}.l)^2", surface.mesh(), view, None, units, **settings),
        )
    white = surface.mesh(colors=np.ones((len(surface.positions), 3)))
    out.append(draw("white less the framebuffer", white, view, None, blending=SUBTRACT_FROM_SOURCE))
    if not mark:
        return tuple(out)
    panel = view.panel
    red_to_alpha = PixelTransfer(color_matrix=((1.0, 0.0, 0.0, 0.0),) * 4)
    state = PassState(
        scissor=panel.scissor, color_mask=NO_COLOR, alpha_test=POSITIVE_ALPHA, stencil_test=MARK
    )
    copy = copy_of_panel("copy red to alpha; mark where it is above zero", panel, state, red_to_alpha)
    return (*out, clear_marks(view), copy)


def imaging_passes(
    surface, forms, normals, view, light, profile, *,
    color, ambient, color_map=None, name="ellipses", shadows=True, sampler=REPEATED,
):  # fmt: skip
    """G16: ambient light, and bump mapping where ``imaging_marking_passes`` leaves marks.

    normals  float64 [rows, columns, 3], unit vectors in the surface's frame

    Other arguments as for ``light_where_marked`` and ``imaging_marking_passes``.
    """
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    lit = f"{name}: (n.l)+"
    vector = _one_light(surface, light)
    table = _positive(_entries(profile), tuple(color))
    image = HostImage.of(normals, profile)
    dark = surface.mesh(colors=np.tile(ambient, (len(surface.positions), 1)))
    units = (unit(lit, sampler, environment=REPLACE),)
    marks, depth_test = (), FIRST_PASS
    if shadows:
        marks = imaging_marking_passes(surface, forms, view, light, profile, name=name, sampler=sampler)
        depth_test = LATER_PASS
    passes = (
        draw("ambient light", dark, view, None, depth_test=depth_test),
        *(_marked if shadows else tuple)(
            (draw("add (n.l)+", surface.mesh(), view, None, units, blending=ADD),)
        ),
    )
    if color_map is not None:
        units = (unit(color_map, sampler, environment=REPLACE),)
        passes += (
            draw("times the colour map", surface.mesh(), view, None, units, blending=MULTIPLY_DESTINATION),
        )
    load_lit = _load_products("load (n.l)+", lit, image, vector, table, InternalFormat.RGB8)
    return (*marks, load_lit, *passes)
