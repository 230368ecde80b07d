"""The still life: a ring, a vase, a column, a sphere and a box on a floor, its camera, and its lamps."""

from dataclasses import replace

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import perspective_view
from fixedpipe.effects.scenes.objects_and_lamps import (
    FLOOR_HALF_WIDTH,
    Object,
    Scene,
    detail_of,
    floor,
    lamp_around,
)

# A turned vase and a column with base and capital: (radius, height).
_VASE = (
    (0.0, 0.0), (0.34, 0.0), (0.36, 0.06), (0.22, 0.14), (0.20, 0.22), (0.34, 0.48), (0.44, 0.78),
    (0.42, 1.02), (0.28, 1.26), (0.17, 1.40), (0.16, 1.52), (0.26, 1.66), (0.0, 1.66),
)  # fmt: skip
_COLUMN = (
    (0.0, 0.0), (0.34, 0.0), (0.34, 0.12), (0.22, 0.2), (0.2, 1.9), (0.3, 2.02), (0.3, 2.14), (0.0, 2.14),
)  # fmt: skip

# The moving light: round the scene from the left to the right.
LAMP_POSITIONS = ((-6.2, 7.0, 3.2), (-1.4, 8.8, 5.0), (5.6, 6.8, 4.4))
# Where the lamp looks, and its field of view: closer than the scene's box, whose upper corners are empty.
# Measured: 39.4 degrees hold every vertex (figure F003-17 checks it).
_LAMP_TARGET, _LAMP_FIELD_OF_VIEW = (0.2, -0.4, -0.4), 40.0


def still_life(detail=40):
    """A ring that stands upright, a vase, a column, a sphere and a box on a floor.

    ``detail``: segments of the round ones (``detail_of``).
    """
    across = detail // 2
    ring = (
        surfaces.torus(detail, across, 0.62, 0.17).rotated(rotation("x", 90.0)).rotated(rotation("y", 38.0))
    )
    return Scene(
        (
            Object("floor", floor(FLOOR_HALF_WIDTH, detail // 2), (0.62, 0.60, 0.56), closed=False),
            Object("ring", ring.moved(-1.35, 0.79, 0.95), (0.80, 0.52, 0.16), 0.6),
            Object("vase", surfaces.lathe(_VASE, detail).moved(0.15, 0.0, -0.35), (0.20, 0.42, 0.62), 0.5),
            Object("column", surfaces.lathe(_COLUMN, detail).moved(-1.7, 0.0, -1.5), (0.66, 0.62, 0.55), 0.1),
            Object(
                "sphere",
                surfaces.sphere(detail, across).scaled(0.5).moved(1.55, 0.5, 0.95),
                (0.72, 0.22, 0.2),
                0.7,
            ),
            Object(
                "box",
                surfaces.box(0.9, 1.2, 0.9).rotated(rotation("y", 25.0)).moved(1.75, 0.6, -1.3),
                (0.34, 0.52, 0.34),
                0.1,
            ),
        )
    )


def still_life_and_lamp(size):
    """The still life with the detail of a panel's size, and a lamp on its left that lights just that."""
    scene = still_life(detail_of(size))
    return scene, replace(
        lamp_around(scene, LAMP_POSITIONS[0], _LAMP_TARGET), field_of_view=_LAMP_FIELD_OF_VIEW
    )


def still_life_view(panel):
    """The camera of ``still_life``."""
    return perspective_view(panel, (0.6, 4.9, 8.4), (0.0, 0.62, 0.0), field_of_view=31.0, radius=4.5)
