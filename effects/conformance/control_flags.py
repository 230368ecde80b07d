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
NEAR_DEPTH = 1.0  # the depth at which the quads stand, depth units
_ARRAYS = ("colors", "secondary_colors", "back_colors", "back_secondary_colors")


@dataclass(frozen=True)
class Corners:
    """What a quad's corners have: colours and normal, four of each. ``back_*``: of the back faces."""

    primary: tuple
    secondary: tuple
    normals: tuple
    back_primary: tuple | None = None
    back_secondary: tuple | None = None


def explanation(name):
    """Why pixels of a case are known to differ."""
    if not name.startswith("ControlFlagsLightDisable") and name.endswith("VS"):
        return "under a vertex program the chip lights with other vertices' inputs; which is not known"
    return ""


def _mesh(positions, corners, **arrays):
    given = {
        "normals": corners.normals,
        "colors": corners.primary,
        "secondary_colors": corners.secondary,
        **arrays,
    }
    return Mesh(positions, PrimitiveType.QUADS, **{name: single(values) for name, values in given.items()})


def _fixed_function(name, corners, lighting, secondary, places):
    """Mesh and vertex state of a quad that the fixed-function stage draws."""
    if name.startswith("ControlFlagsLightDisable"):
        # With two sides and no lighting the chip's back faces are opaque black.
        back = replace(lighting.back, diffuse=(0.0, 0.0, 0.0, 1.0)) if lighting.two_side else None
        unlit = {"lights": (), "model_ambient": lit_scenes.BLACK, "separate_specular_color": True}
        lighting = replace(lighting, back=back, **unlit) if lighting.two_side else None
        secondary = SecondaryColor.OPAQUE if lighting is not None else secondary
    positions = np.array([lit_scenes.unproject(x, y, 1.0 - lit_scenes.EYE_DISTANCE) for x, y in places])
    vertex = replace(lit_scenes.view(), lighting=lighting, secondary_color=secondary)
    return _mesh(positions, corners), vertex


def _program(name, corners, lighting, secondary, places):
    """Mesh and vertex state of a quad that a vertex program draws.

    With lighting, the lighting unit replaces the program's colours.
    """
    points = np.array([vertex_programs.unproject(x, y, NEAR_DEPTH) for x, y in places])
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


def draws(name, corners, lighting, polygon=scenes.FRONT_FACES):
    """The quads of the case ``name``; ``lighting`` as the case ControlFlags_FF has it; ``polygon``: facing
    and culling.
    """
    if name.startswith("ControlFlagsNoLight"):
        lighting = replace(lighting, lights=())
    build = _program if name.endswith("VS") else _fixed_function
    commands = []
    for row, (enabled, shown) in enumerate(ROWS):
        top = QUAD_HEIGHT + SPACING + row * (QUAD_HEIGHT + SPACING)
        for column, (separate, alpha) in enumerate(COLUMNS):
            left = QUAD_WIDTH + column * (QUAD_WIDTH + SPACING)
            secondary = SecondaryColor.FROM_VERTEX if alpha else SecondaryColor.OPAQUE
            secondary = secondary if enabled else SecondaryColor.DISABLED
            places = [(x, y) for x, y, _ in scenes.rectangle(left, top, left + QUAD_WIDTH, top + QUAD_HEIGHT)]
            controlled = replace(lighting, separate_specular_color=separate)
            mesh, vertex = build(name, corners, controlled, secondary, places)
            state = replace(
                scenes.DEFAULT, vertex=vertex, polygon=polygon, register_combiners=scenes.shows(shown)
            )
            commands.append(Draw(label=f"row {row}, column {column}", mesh=mesh, state=state))
    return commands
