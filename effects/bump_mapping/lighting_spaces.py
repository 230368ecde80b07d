"""Z05, Z06 and Z07: one bump-mapped lighting in camera, in object and in tangent space.

All three give the ambient colour + colour (n.l)+ + min(1, 4 (n.l)+) k (n.h)^8. They differ in the space in
which l, h and the map's normal meet:

Z05, camera space. n_camera = modelview [t b n] bm at every pixel, made of length one there. The document's
fragment program is a texture shader's three dot products: unit 0 reads the map, units 1 to 3 multiply it by
the rows of modelview [t b n], which are their texture coordinates, and look the result up in a normalization
cube map. Combiners do the rest in the same pass, with l and h of camera space as colours. Of the modelview
matrix its 3x3 part turns t and b, and that part's cofactors n (erratum E003.3). Z06, object space. The map
holds normals of the object's own axes, so it fits that one object alone, and a distant light is one vector:
K10's and K14's passes with frames that are the object's axes. The imaging subset needs no units at all: the
map is loaded through a colour matrix whose rows are l, once for the whole object, and again for h. Z07,
tangent space. K10's and K14's passes (A-H43): l and h go to tangent space at every vertex, and the
interpolated vectors are nearly, but not quite, of length one. The document calls it the more efficient.

Source: Zwicker 2016, "Rendering" and "Variations"; NV_texture_shader, section 3.8.13.1.17; Kilgard 2000;
pass sequences A-Z05, A-Z06, A-Z07 and A-H43 of the catalogue.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.bump_mapping import diffuse_bump, normalization_cube_map
from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import cross, from_frame, normalize
from fixedpipe.effects.passes import host_images
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    PRIMARY,
    SECONDARY,
    SPARE0,
    SPARE1,
    TEXTURE3,
    alpha_of,
    both,
    dot,
    expand,
    final,
    gate,
    product,
    program,
    square,
    stage,
    total,
)
from fixedpipe.effects.passes.draws import (
    ADD_GATED,
    EDGE,
    FIRST_PASS,
    LATER_PASS,
    REPEATED,
    REPLACE,
    draw,
    unit,
)
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.passes.texture_shaders import (
    NO_TEXTURE,
    TEXTURE_STAGE,
    dot_product_stages,
)
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import BaseFormat, InternalFormat
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import ColorTable

TECHNIQUES = (
    Technique("Z05", "bumps lit in camera space: normals turned at every pixel", "Rendering"),
    Technique("Z06", "bumps lit in object space: a map of the object's own normals", "Variations"),
    Technique("Z07", "bumps lit in tangent space: the light turned at every vertex", "Variations"),
)

# ------------------------------------------------------------------------------------ Z05: camera space


def camera_frames(surface, view):
    """(t, b, n) of a surface's vertices in camera space, float64 [n, 3] each, as long as they come out."""
    turn = np.array(view.modelview)[:3, :3]
    cofactors = np.stack([cross(turn[1], turn[2]), cross(turn[2], turn[0]), cross(turn[0], turn[1])])
    return rotate(turn, surface.tangents), rotate(turn, surface.binormals), rotate(cofactors, surface.normals)


def rows(surface, view):
    """The three rows of modelview [t b n] at the vertices: texture coordinates float64 [n, 3] each."""
    frames = camera_frames(surface, view)
    return tuple(np.stack([axis[:, k] for axis in frames], axis=-1) for k in range(3))


def _camera_combiners(color, ambient):
    """(n.l)+ color + ambient + min(1, 4 (n.l)+) (n.h)^8: n of unit 3, l primary, h secondary."""
    n = expand(TEXTURE3)
    return program(
        both(dot(n, expand(PRIMARY), to=SPARE0), dot(n, expand(SECONDARY), to=SPARE1)),
        stage(total(product(SPARE0, CONSTANT0), CONSTANT1, to=SPARE0), alpha=gate(SPARE0)),
        square(SPARE1, to=SPARE1),
        square(SPARE1, to=SPARE1),
        final(alpha_of(SPARE0), square(SPARE1), plus=SPARE0),
        constant0=color,
        constant1=ambient,
    )


def camera_space_pass(
    surface,
    normal_map,
    view,
    light,
    profile,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    specular=1.0,
    sampler=REPEATED,
):
    """Z05 in one draw; ``normalization_cube_map.load`` has loaded the cube map.

    ``normal_map``: the name of a texture with normals for dot products
    (``dot_product_lookups.dot_product_texels``); colours RGB in [0, 1]; ``specular``: k, in [0, 1].
    """
    turn = np.array(view.modelview)[:3, :3]
    to_light = light.light_vectors(surface.positions)
    halfway = normalize(to_light + view.view_vectors(surface.positions))
    to_light, halfway = (normalize(rotate(turn, vectors)) for vectors in (to_light, halfway))
    mesh = surface.mesh(
        surface.texture_coordinates,
        *rows(surface, view),
        colors=vector_colors(to_light, profile),
        secondary_colors=vector_colors(diffuse_bump.eighth_root(specular) * halfway, profile),
    )
    units = (
        unit(normal_map, sampler),
        unit(NO_TEXTURE, coordinates=1),
        unit(NO_TEXTURE, coordinates=2),
        unit(normalization_cube_map.NAME, EDGE, coordinates=3),
    )
    stages = (TEXTURE_STAGE, *dot_product_stages(0, 0, 0, lookup=Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP))
    return (
        draw(
            "camera space: n = modelview [t b n] bm, of length one; (n.l)+ and (n.h)^8",
            mesh,
            view,
            _camera_combiners(color, ambient),
            units,
            depth_test=FIRST_PASS,
            texture_shader=stages,
        ),
    )


# ------------------------------------------------------------------------------------ Z06: object space


def object_space_normals(normals, frames):
    """A normal map of an object's own axes: float64 [rows, columns, 3] of length one.

    normals  float64 [rows, columns, 3], in tangent space
    frames   (normals, tangents, binormals) of the object at the texels, float64 [rows, columns, 3] each, as
             ``surfaces.sphere_frames`` gives them
    """
    normal, tangent, binormal = frames
    return normalize(from_frame(normals, tangent, binormal, normal))


def with_object_axes(surface, axes=None):
    """The surface with the object's axes for its frames, so that vectors "in local frames" are the object's.

    ``axes``: float64 [3, 3], the object's x, y and z in world coordinates, each a row; None: the world's.
    """
    axes = np.eye(3) if axes is None else np.asarray(axes, np.float64)
    x, y, z = (np.tile(row, (len(surface.positions), 1)) for row in axes)
    return replace(surface, tangents=x, binormals=y, normals=z)


def object_space_passes(
    surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=1.0, axes=None
):
    """Z06 with combiners: K14's two draws with a map of the object's axes.

    ``normal_map``: the name of a texture with ``object_space_normals`` for EXPAND_NORMAL.
    """
    turned = with_object_axes(surface, axes)
    return diffuse_bump.commands(
        turned, normal_map, view, light, profile, color=color, ambient=ambient, specular=specular
    )


TABLE_ENTRIES = 256


def _constant(vectors, what):
    """One vector that all vertices share. Raises ValueError where they do not."""
    if np.abs(vectors - vectors[:1]).max() > 1e-12:
        raise ValueError(
            f"{what} differs from vertex to vertex; a colour matrix holds one. Give a directional light and "
            "an infinite viewer (fixedpipe.effects.geometry.views.orthographic_view), or draw polygon by "
            "polygon (fixedpipe.effects.reflectance.imaging_subset)."
        )
    return vectors[0]


def color_matrix_passes(
    surface,
    normals,
    view,
    light,
    profile,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    specular=1.0,
    axes=None,
    sampler=REPEATED,
):
    """Z06 with the imaging subset: the map loaded twice through a colour matrix and a table, two draws.

    ``normals``: ``object_space_normals``, which the host keeps. Raises ValueError if the light or the viewer
    is not infinitely far away.
    """
    turned = with_object_axes(surface, axes)
    to_light = light.light_vectors(surface.positions)
    halfway = normalize(to_light + view.view_vectors(surface.positions))
    image = host_images.HostImage.of(normals, profile)
    entries = profile.pixels.max_color_table_size if profile.arithmetic.exact else TABLE_ENTRIES
    lit = np.maximum(0.0, 2.0 * (np.arange(entries) / float(entries - 1)) - 1.0)
    square = lit * lit
    power = specular * ((square * square) * (square * square))
    gate = np.minimum(1.0, 4.0 * lit)
    channels = (*(c * lit + a for c, a in zip(color, ambient, strict=True)), gate)
    tables = (
        ("colour (n.l)+ + ambient, gate", to_light, "The light vector", InternalFormat.RGBA8, None,
         FIRST_PASS, ColorTable(tuple(zip(*(c.tolist() for c in channels), strict=True)))),
        ("(n.h)^8", halfway, "The halfway vector", InternalFormat.LUMINANCE8, ADD_GATED,
         LATER_PASS, ColorTable(tuple((p, 0.0, 0.0, 0.0) for p in power.tolist()), BaseFormat.LUMINANCE)),
    )  # fmt: skip
    out = []
    for what, vectors, name, internal_format, blending, depth_test, table in tables:
        vector = _constant(turned.to_local(vectors), name)
        out += (
            TexImage(
                label=f"load the normal map through the colour matrix: {what}",
                texture=what,
                pixels=PixelImage(image.values, "RGB"),
                internal_format=internal_format,
                transfer=host_images.dot_product_transfer(vector, image.scale, table),
            ),
            draw(
                f"draw the object with {what}",
                surface.mesh(),
                view,
                None,
                (unit(what, sampler, environment=REPLACE),),
                depth_test=depth_test,
                blending=blending,
            ),
        )
    return tuple(out)


# ----------------------------------------------------------------------------------- Z07: tangent space


def tangent_space_passes(
    surface, normal_map, view, light, profile, *, color, ambient=(0.0, 0.0, 0.0), specular=1.0
):
    """Z07: K14's two draws. ``normal_map``: the name of a texture for EXPAND_NORMAL."""
    return diffuse_bump.commands(
        surface, normal_map, view, light, profile, color=color, ambient=ambient, specular=specular
    )
