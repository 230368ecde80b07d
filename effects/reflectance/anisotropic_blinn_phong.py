"""K07 and K11: the simplified anisotropic Blinn-Phong model in one pass of register combiners, and its
frames.

Eq. 1: L_o = k_s (1 - (h.t/alpha_x)^2 - (h.b/alpha_y)^2)+. Texture unit 0 holds t/(4 alpha_x) and k_s, unit 1
b/(4 alpha_y), and the primary colour the halfway vector. The first general combiner computes both dot
products and multiplies them by four. The second squares and adds. The final combiner subtracts from one and
multiplies by k_s times the light's colour. Results beyond [-1, 1] saturate; there Eq. 1 is zero anyway
(erratum E004.8).

A board with one texture unit, or one general combiner, has one material vector in a pass. Then the
framebuffer adds the squares, and also subtracts them from one (``specular_passes``).

K11 has two choices of frame. The paper's choice turns the halfway vector into the surface's local frame at
every vertex. The other bakes the material textures in world coordinates for one surface, and leaves the
halfway vector unchanged.

Source: Kautz, Seidel 2000, sections 3.2, 4 and 4.1, Eq. 1 (K07, K11 of the catalogue; pass sequence A-K07).
"""

from fixedpipe.effects.geometry.vectors import from_frame, normalize
from fixedpipe.effects.geometry.vertex_vectors import half_vectors
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    PRIMARY,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    alpha_of,
    both,
    constant_product,
    dot,
    expand,
    final,
    negated,
    one_minus,
    product,
    program,
    scaled,
    signed,
    square,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD,
    ADD_GATED,
    FIRST_PASS,
    INVERT_DESTINATION,
    LATER_PASS,
    REPEATED,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.reflectance.material_textures import Material
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import Saturate

TECHNIQUES = (
    Technique("K07", "Eq. 1, the simplified anisotropic Blinn-Phong model, by register combiners", "4.1"),
    Technique("K11", "a material's vectors in the surface's frame, or in world coordinates", "4"),
)


def combiners(specular=(1.0, 1.0, 1.0)):
    """Eq. 1 as two general combiners and the final combiner; ``specular``: RGB that multiplies k_s."""
    h = expand(PRIMARY)
    return program(
        scaled(4, both(dot(expand(TEXTURE0), h, to=SPARE0), dot(expand(TEXTURE1), h, to=SPARE1))),
        total(square(signed(SPARE0)), square(signed(SPARE1)), to=SPARE0),
        final(one_minus(SPARE0), product(CONSTANT0, alpha_of(TEXTURE0))),
        constant0=specular,
    )


def square_combiners():
    """(4 T'.h)^2, at most one, by one general combiner.

    The final combiner squares the dot product's positive and negative half and adds them; one half is zero.
    """
    t, h = expand(TEXTURE0), expand(PRIMARY)
    return program(
        scaled(4, both(dot(t, h, to=SPARE0), dot(negated(t), h, to=SPARE1))),
        final(SPARE0, SPARE0, plus=square(SPARE1)),
    )


def specular_passes(surface, names, view, light, profile, *, specular=(1.0, 1.0, 1.0), sampler=REPEATED):
    """Eq. 1 with one texture unit and one general combiner in a pass: three draws, which replace what the
    framebuffer holds.

    Parameters as for ``specular_pass``.
    """
    mesh = surface.mesh(colors=vector_colors(half_vectors(surface, view, light), profile))
    tangent, binormal = unit(names.tangent, sampler), unit(names.binormal, sampler)

    k_s = constant_product(alpha_of(TEXTURE0), specular)
    return (
        draw("(h.t/ax)^2", mesh, view, square_combiners(), (tangent,), depth_test=FIRST_PASS),
        draw("add (h.b/ay)^2", mesh, view, square_combiners(), (binormal,), blending=ADD),
        Saturate(label="at most one, as the framebuffer holds it", scissor=view.panel.scissor),
        draw("k_s times one minus that", mesh, view, k_s, (tangent,), blending=INVERT_DESTINATION),
    )


def specular_pass(
    surface,
    names,
    view,
    light,
    profile,
    *,
    specular=(1.0, 1.0, 1.0),
    first=False,
    gated=True,
    global_frame=False,
    sampler=REPEATED,
):
    """Eq. 1 in one draw.

    Parameters
    ----------
    surface, view, light
        The surface, the view and the light.
    names
        The material's texture objects (``material_textures.MaterialNames``).
    specular
        RGB in [0, 1], by which k_s is multiplied.
    first
        The only pass over the surface: tests and writes depth, and replaces. Otherwise it is added to the
        diffuse pass where depths are equal, and if ``gated`` multiplied by the gate in destination alpha.
    sampler
        Of the material's textures.
    global_frame
        K11: the material textures are in world coordinates, and so is the halfway vector.
    """
    if global_frame:
        positions = surface.positions
        vectors = normalize(light.light_vectors(positions) + view.view_vectors(positions))
    else:
        vectors = half_vectors(surface, view, light)
    return (
        draw(
            "specular pass: k_s (1 - (h.t/ax)^2 - (h.b/ay)^2)+",
            surface.mesh(colors=vector_colors(vectors, profile)),
            view,
            combiners(specular),
            (unit(names.tangent, sampler), unit(names.binormal, sampler)),
            depth_test=FIRST_PASS if first else LATER_PASS,
            blending=None if first else ADD_GATED if gated else ADD,
        ),
    )


def bake(material, normals, tangents, binormals):
    """K11: the material in world coordinates, for the one surface whose frames at the texels are given.

    ``normals, tangents, binormals``: float64 [rows, columns, 3], the surface's frame at every texel centre.
    """
    turned = (
        from_frame(vectors, tangents, binormals, normals)
        for vectors in (material.normals, material.tangents, material.binormals)
    )
    return Material(*turned, material.alpha_x, material.alpha_y, material.k_s, material.exponent)
