"""The ControlFlags cases of Specular and Specular_back: four rows of quads, a column for each light control.

Source: TestControlFlags in src/tests/specular_tests.cpp and specular_back_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.scenes import single
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType, Register, SecondaryColor

STAGES = ("FF", "VS")
NAMES = [f"ControlFlags{light}_{stage}" for light in ("LightDisable", "NoLight", "") for stage in STAGES]
QUAD_WIDTH, QUAD_HEIGHT, SPACING = WIDTH / 6, HEIGHT / 6, 15.0
COLUMNS = ((True, True), (True, False), (False, True), (False, False))  # separate specular color, alpha
ROWS = (  # whether there is a secondary colour, which colour is shown
    (False, Register.SECONDARY_COLOR),
    (False, Register.PRIMARY_COLOR),
    (True, Register.SECONDARY_COLOR),
    (True, Register.PRIMARY_COLOR),
)
# Six vertices are under way at a time, each at a place of its own. A vertex program leaves the fixed-function
# stage's normals there, so the unit lights with those of the last six vertices that this stage transformed:
# the last of the FF case before. Measured: each row of both ControlFlags_VS captures repeats after six
# vertices, and has the two last quads' normals in their order.
LAST_SIX = (2, 3, 0, 1, 2, 3)  # corners
_ARRAYS = ("colors", "secondary_colors", "back_colors", "back_secondary_colors")


@dataclass(frozen=True)
class Corners:
    """What a quad's corners have: colours and normal, four of each. ``back_*``: of the back faces."""

    primary: tuple
    secondary: tuple
    normals: tuple
    back_primary: tuple | None = None
    back_secondary: tuple | None = None


def _mesh(positions, corners, **arrays):
    given = {
        "normals": corners.normals,
        "colors": corners.primary,
        "secondary_colors": corners.secondary,
        **arrays,
    }
    return Mesh(positions, PrimitiveType.QUADS, **{name: single(values) for name, values in given.items()})


def _left_normals(corners, place, column):
    """The normals by which a quad of a row is lit under a vertex program: of the places from ``place`` on for
    the row's first vertex.
    """
    return [corners.normals[LAST_SIX[(place + 4 * column + k) % 6]] for k in range(4)]


def _fixed_function(name, corners, lighting, secondary, points):
    """Mesh and vertex state of a quad that the fixed-function stage draws."""
    if name.startswith("ControlFlagsLightDisable"):
        # With two sides and no lighting the chip's back faces are opaque black.
        back = replace(lighting.back, diffuse=(0.0, 0.0, 0.0, 1.0)) if lighting.two_side else None
        unlit = {"lights": (), "model_ambient": lit_scenes.BLACK, "separate_specular_color": True}
        lighting = replace(lighting, back=back, **unlit) if lighting.two_side else None
        secondary = SecondaryColor.OPAQUE if lighting is not None else secondary
    vertex = replace(lit_scenes.view(), lighting=lighting, secondary_color=secondary)
    return _mesh(points, corners), vertex


def _program(name, corners, lighting, secondary, points):
    """Mesh and vertex state of a quad that a vertex program draws.

    With lighting, the lighting unit replaces the program's colours.
    """
    window = vertex_programs.perspective(points)
    mesh = scenes.window_mesh(window, PrimitiveType.QUADS)
    vertex = replace(scenes.PROGRAM_RESULTS, two_side=lighting.two_side, secondary_color=secondary)
    sides = [(corners.primary, corners.secondary)]
    if corners.back_primary is not None:
        sides.append((corners.back_primary, corners.back_secondary))
    if not name.startswith("ControlFlagsLightDisable"):
        lit = replace(lit_scenes.view(), lighting=lighting, secondary_color=secondary)
        sides = lit_scenes.lit_colors(lit, points, corners.normals, sides)
    arrays = dict(zip(_ARRAYS, sum(sides, ()), strict=False))
    return _mesh(mesh.positions, corners, **arrays), vertex


def draws(name, corners, lighting, unproject, first_places, polygon=scenes.FRONT_FACES):
    """The quads of the case ``name``; ``lighting`` as the case ControlFlags_FF has it.

    unproject     by stage, the world position [3] of a device pixel's x and y
    first_places  of each row's first vertex under a vertex program
    polygon       facing and culling
    """
    if name.startswith("ControlFlagsNoLight"):
        lighting = replace(lighting, lights=())
    stage = name[-2:]
    build = _program if stage == "VS" else _fixed_function
    commands = []
    for row, (enabled, shown) in enumerate(ROWS):
        top = QUAD_HEIGHT + SPACING + row * (QUAD_HEIGHT + SPACING)
        for column, (separate, alpha) in enumerate(COLUMNS):
            left = QUAD_WIDTH + column * (QUAD_WIDTH + SPACING)
            secondary = SecondaryColor.FROM_VERTEX if alpha else SecondaryColor.OPAQUE
            secondary = secondary if enabled else SecondaryColor.DISABLED
            places = scenes.rectangle(left, top, left + QUAD_WIDTH, top + QUAD_HEIGHT)
            points = np.array([unproject[stage](x, y) for x, y, _ in places])
            controlled = replace(lighting, separate_specular_color=separate)
            given = corners
            if build is _program:
                given = replace(corners, normals=_left_normals(corners, first_places[row], column))
            mesh, vertex = build(name, given, controlled, secondary, points)
            state = replace(
                scenes.DEFAULT, vertex=vertex, polygon=polygon, register_combiners=scenes.shows(shown)
            )
            commands.append(Draw(label=f"row {row}, column {column}", mesh=mesh, state=state))
    return commands
