"""F003-4: a bump map encoded as RGB, in the document's order of components and in tangent space's."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.bump_mapping import normal_maps
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, draw, unit
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_2d


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
    """The figure's bytes: three uint8 [edge, edge, 3], one texel for each pixel where the size is a power of
    two: the heights, the document's order, tangent space's. Of the medal, or of a height field.
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
    """What is stored of flat texels and of others, and that the machine shows these bytes."""
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
        Check(
            "normals - those of the surface's tangents, largest component",
            float(np.abs(normals - true).max()), at_most=1e-12, on=Answer.IDEAL,
            reason="float64: the printed cross product, re-ordered, is (-d_u, -d_v, 1)",
        ),
        Check("share of flat texels", float(flat.mean()), at_least=0.2, on=Answer.IDEAL,
              reason="what is between the domes"),
        Check(
            "flat texels - (128, 128, 255), largest, as the machine shows them",
            float(np.abs(panel_of(picture, 2)[flat] - np.array([128.0, 128.0, 255.0])).max()), at_most=1e-6,
            on=Answer.MACHINE, reason="half of 255 rounds upwards: the catalogue's",
        ),
        Check(
            "the same of the document's order - (255, 128, 128)",
            float(np.abs(panel_of(picture, 1)[flat] - np.array([255.0, 128.0, 128.0])).max()), at_most=1e-6,
            on=Answer.MACHINE, reason="the height is the first component (E003.1)",
        ),
        Check(
            "decode error, largest component", float(np.abs(read - true).max()), at_most=1.0 / 255.0 + 1e-9,
            on=Answer.MACHINE, reason="half a byte of 2/255: the catalogue's",
        ),
        Check("the picture - what is stored, bytes", float(max(shown)), at_most=1e-6, on=Answer.MACHINE,
              reason="a texture that replaces: the same bytes"),
    )  # fmt: skip


FIGURE = Figure(
    id="F003-4",
    title="Normals as colours",
    caption=(
        "A displacement map; its normals as RGB in the order in which the document derives them, height "
        "first; and in the order of tangent space, height last."
    ),
    must_see=(
        "Left a grey medal; in the middle the same in reds, right in the blues of normal maps; what is flat "
        "is one colour, (255, 128, 128) and (128, 128, 255)."
    ),
    source="Zwicker2016",
    techniques=("Z01", "Z02"),
    panels=("displacement", "(h, u, v)", "(u, v, h)"),
    parameters={
        "height_field": own_maps.height_field("the medal", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.1),
    },
    methods=(Method("texture environments", scene, ("OPENGL_1_2", "GEFORCE_256", "OCTANE")),),
    acceptance=checks,
)
