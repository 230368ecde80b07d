"""H31: Phong highlights of directional lights drawn into an environment map.

    map(r) = sum over the lights of color (r.l)+^e

The map begins black, and each light adds its lobe. Looked up along the reflected vector, it gives Phong's
highlights at every pixel, even on a coarse mesh. The cost is one texture for any number of lights.

There are two ways. The host adds the lobes in a cube map of floats. Or the window adds them, in a sphere map
for the view. For each light it draws a net of directions over the map's square. The directions are texture
coordinates, a texture matrix with l in its first row makes r.l of them, and a table of one row has the power.
Then the square is copied to a texture. So lights may move from frame to frame.

Source: Voorhies, Foran 1994; Heidrich 2001, section 1.6; pass sequence A-H31 of the catalogue.
"""

import numpy as np

from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.matrices import rotate
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.passes.draws import ADD, EDGE, MODULATE, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance.sampled_functions import positions
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import CopyTexImage, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import InternalFormat, PrimitiveType
from fixedpipe.pipeline.state import PassState, VertexState, Viewport
from fixedpipe.pipeline.textures.images import texture_1d

TECHNIQUES = (
    Technique("H31", "Phong highlights of directional lights drawn into an environment map", "1.6"),
)

POWER, TEXELS = "power of r.l", 1024


def powers(values, exponent):
    """(x)+ to a whole exponent from 1 on, by squaring: the same bits everywhere."""
    if isinstance(exponent, bool) or int(exponent) != exponent or exponent < 1:
        raise ValueError(f"The exponent is {exponent!r}; give a whole number from 1 on.")
    left, square, out = int(exponent), np.maximum(values, 0.0), 1.0
    while left:
        if left & 1:
            out = out * square
        square, left = square * square, left >> 1
    return out


def highlights(toward, lights, exponent):
    """What unit directions [..., 3] reflect of lights: RGB float64 [..., 3], the sum of their lobes.

    lights    pairs of a direction to the light and its colour, RGB
    exponent  Phong's, a whole number from 1 on
    """
    out = np.zeros(np.shape(toward))
    for direction, color in lights:
        lobe = powers(dot(toward, unit_vector(direction, "The light's direction")), exponent)
        out = out + lobe[..., None] * np.array(color)
    return out


def cube(size, lights, exponent):
    """The lobes as a cube map of floats [6, size, size, 3]."""
    return highlights(cube_maps.directions(size), lights, exponent)


def _net(cells):
    """A square's net: places [n, 2] from -1 to 1, directions that a sphere map has there, in eye coordinates
    [n, 3], and quadrilaterals [m, 4]. Beyond the circle, what its edge has.
    """
    edge = 2.0 * np.arange(cells + 1) / cells - 1.0
    x, y = (a.ravel() for a in np.meshgrid(edge, edge))
    square = x * x + y * y
    shrink = 1.0 / np.sqrt(np.maximum(square, 1.0))
    u, v = x * shrink, y * shrink
    z = np.sqrt(np.maximum(0.0, 1.0 - (u * u + v * v)))
    toward = np.stack([2.0 * z * u, 2.0 * z * v, 2.0 * z * z - 1.0], axis=-1)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    quads = np.stack([corner, corner + 1, corner + cells + 2, corner + cells + 1], axis=-1)
    return np.stack([x, y], axis=-1), toward, quads


def draw_sphere_map(name, lights, exponent, view, size, profile, cells=32):
    """Commands that draw the lobes into the window and copy them to a sphere map texture ``name`` for a view.

    They use the lower left ``size`` by ``size`` pixels, cleared to black first, and overwrite them.
    ``cells``: cells of the net along an edge.
    """
    table = factor_texels(powers(positions(TEXELS), exponent), profile)
    places, in_eye, quads = _net(cells)
    toward = rotate(np.array(view.modelview)[:3, :3].T, in_eye)
    vertex = VertexState(viewport=Viewport(0, 0, size, size))

    def drawn(label, **settings):
        given = settings.pop("mesh")
        mesh = Mesh(places, PrimitiveType.QUADS, indices=quads.ravel(), **given)
        return Draw(label=label, mesh=mesh, state=PassState(vertex=vertex, **settings))

    image = texture_1d(table[..., None], InternalFormat.LUMINANCE8)
    out = [
        TexImage(label=f"load the {POWER}", texture=POWER, image=image),
        drawn("the map begins black", mesh={"colors": np.zeros((len(places), 3))}),
    ]
    for number, (direction, color) in enumerate(lights):
        x, y, z = (float(c) for c in unit_vector(direction, "The light's direction"))
        rows = ((x, y, z, 0.0), (0.0,) * 4, (0.0,) * 4, (0.0, 0.0, 0.0, 1.0))
        lobe = {
            "colors": np.broadcast_to(np.array(color, np.float64), (len(places), 3)),
            "texture_coordinates": (toward,),
        }
        out.append(
            drawn(
                f"the lobe of light {number + 1}, added",
                mesh=lobe,
                texture_units=(unit(POWER, EDGE, environment=MODULATE, matrix=rows),),
                blending=ADD,
            )
        )
    copy = CopyTexImage(
        label="the square becomes a texture",
        texture=name,
        internal_format=InternalFormat.RGB8,
        width=size,
        height=size,
    )
    return (*out, copy)
