"""F003-4: a bump map encoded as RGB, in the document's order of components and in tangent space's."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import normal_maps
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, draw, unit
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F003-4")


def rosette(edge):
    """Heights of a medal, float64 [edge, edge], in units of the map's edge: a dome in the middle, eight round
    it, and a rim; flat between.
    """
    s, t = height_fields.texel_centers(edge, edge)
    x, y = 2.0 * s - 1.0, 2.0 * t - 1.0
    # Eighths of a turn on a circle, rounded so that they are the same everywhere.
    ring = [(0.5, 0.0), (0.3535, 0.3535), (0.0, 0.5), (-0.3535, 0.3535)]
    centers = [(0.0, 0.0, 0.26), *((sign * a, sign * b, 0.15) for a, b in ring for sign in (1.0, -1.0))]
    heights = np.zeros((edge, edge))
    for a, b, radius in centers:
        square = radius * radius - ((x - a) * (x - a) + (y - b) * (y - b))
        heights = np.maximum(heights, 0.8 * np.sqrt(np.maximum(square, 0.0)))
    across = np.sqrt(x * x + y * y) - 0.82
    heights = np.maximum(heights, 0.8 * np.sqrt(np.maximum(0.0081 - across * across, 0.0)))
    return 0.5 * height_fields.smooth(heights, 2)


def stored(size, height_field=None, height_scale=0.0):
    """The figure's bytes: three uint8 [edge, edge, 3], of the medal or of a height field.

    They are the heights, the document's order and tangent space's, with one texel for each pixel if the size
    is a power of two.
    """
    edge = 1 << (size - 1).bit_length()
    own = height_field is not None
    heights = height_field.fitted(edge, edge, height_scale, repeated=False) if own else rosette(edge)
    highest = heights.max() or 1.0
    grey = np.floor(255.0 * heights / highest + 0.5).astype(np.uint8)
    printed = normal_maps.height_first_normals(heights, 1.0 / edge, 1.0 / edge, periodic=not own)
    vectors = (printed, normal_maps.tangent_space_order(printed))
    return np.repeat(grey[..., None], 3, axis=-1), *(normal_maps.encode(v) for v in vectors)


NAMES = ("displacement map", "normals, height first", "normals, height last")


def scene(profile, size, *, height_field, height_scale):
    """F003-4: three pictures, drawn as textures on squares that fill their panels."""
    images, out = stored(size, height_field, height_scale), []
    for panel, name, image in zip(row_of_panels(3, size), NAMES, images, strict=True):
        texture = texture_2d(image, InternalFormat.RGB8)
        view = orthographic_view(panel)
        show = unit(name, NEAREST, environment=REPLACE)
        out += (
            TexImage(label=f"load {name}", texture=name, image=texture),
            panel.clear((0.0, 0.0, 0.0)),
            draw(f"show {name}", surfaces.plane().mesh(), view, None, (show,), depth_test=None),
        )
    return tuple(out)


def checks(figure, renderer):
    """The stored normals of flat and of other texels, and that the machine shows these bytes."""
    size = 128
    heights = rosette(size)
    normals = normal_maps.normals(heights, 1.0 / size, 1.0 / size)
    images = stored(size)
    true = height_fields.frames(*height_fields.slopes(heights))[0]
    flat = (true[..., :2] == 0.0).all(axis=-1)
    picture = 255.0 * renderer.machine_window(figure, size)
    shown = [np.abs(panel_of(picture, k) - image).max() for k, image in enumerate(images)]
    read = normal_maps.decode(panel_of(picture, 2) + 0.0)
    return (
        DATA.check(
            "normals - those of the surface's tangents, largest component",
            float(np.abs(normals - true).max()),
            Answer.IDEAL,
        ),
        DATA.check("share of flat texels", float(flat.mean()), Answer.IDEAL),
        DATA.check(
            "flat texels - (128, 128, 255), largest, as the machine shows them",
            float(np.abs(panel_of(picture, 2)[flat] - np.array([128.0, 128.0, 255.0])).max()),
            Answer.MACHINE,
        ),
        DATA.check(
            "the same of the document's order - (255, 128, 128)",
            float(np.abs(panel_of(picture, 1)[flat] - np.array([255.0, 128.0, 128.0])).max()),
            Answer.MACHINE,
        ),
        DATA.check(
            "decode error, largest component",
            float(np.abs(read - true).max()),
            Answer.MACHINE,
            at_most=1.0 / 255.0 + 1e-9,
        ),
        DATA.check("the picture - what is stored, bytes", float(max(shown)), Answer.MACHINE),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "height_field": own_maps.height_field("the medal", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.1),
    },
    methods=(Method("texture environments", scene, ("OPENGL_1_2", "GEFORCE_256", "OCTANE")),),
    acceptance=checks,
)
