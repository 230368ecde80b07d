"""F004-7: the material textures of the marble of F004-6."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.own_marble import OWN, marble
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.passes.draws import NEAREST, unit
from fixedpipe.effects.passes.encoding import vectors_of_texels
from fixedpipe.effects.reflectance import material_textures
from fixedpipe.effects.scenes.marble import MAP_SIZE, MARBLE
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.enums import TextureEnvironmentMode
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from fixedpipe.pipeline.state import PassState, TextureEnvironment, VertexState

DATA = figure_data(__file__, "F004-7")

# The paper's board, then all others that draw at all.
MACHINES = ("GEFORCE_256", *(key for key in PROFILES if key not in ("GEFORCE_256", "IDEAL")))


def scene(profile, size, *, height_field, height_scale, photograph):
    """F004-7: left T' = t / (4 alpha_x), right B' = b / (4 alpha_y), as the colours that are stored.

    One texture unit and the environment REPLACE: any board can show them.
    """
    stone = marble(MAP_SIZE, height_field, height_scale, photograph, **MARBLE)
    (_, *loading), names = material_textures.load(stone.material, "marble", profile)
    out = list(loading)
    for panel, name in zip(row_of_panels(2, size), (names.tangent, names.binormal), strict=True):
        out += (
            panel.clear((0.0, 0.0, 0.0)),
            Draw(
                label=f"show {name}",
                mesh=surfaces.plane().mesh(),
                state=PassState(
                    vertex=VertexState(viewport=panel.viewport),
                    texture_units=(
                        unit(name, NEAREST, environment=TextureEnvironment(TextureEnvironmentMode.REPLACE)),
                    ),
                ),
            ),
        )
    return tuple(out)


def checks(figure, renderer):
    """The vectors read back from the picture, a texel per pixel: their lengths and their right angle."""
    material = material_textures.marble(MAP_SIZE, **MARBLE).material
    # The stone between the veins, and what of the veins' tops is level.
    level = material.normals[..., 2] > 1.0 - 1e-9
    for on, profile, length_bound, angle_bound, reason in (
        (Answer.IDEAL, IDEAL, 1e-6, 1e-6, "float64: what was authored"),
        (
            Answer.MACHINE,
            renderer.profile,
            4 * 2.0 / 255,
            0.03,
            "the catalogue's acceptance: one step of a stored component, 2/255, times the scale of four",
        ),
    ):
        image = renderer.window(on, figure, MAP_SIZE)
        stored = image if profile.arithmetic.exact else np.floor(255.0 * image + 0.5)
        decoded = vectors_of_texels(stored, profile) / material_textures.STORAGE_SCALE
        tangents, binormals = decoded[:, :MAP_SIZE], decoded[:, MAP_SIZE:]
        for name, vectors, alpha in (
            ("T| = 1 / alpha_x", tangents, material.alpha_x),
            ("B| = 1 / alpha_y", binormals, material.alpha_y),
        ):
            error = float(np.abs(np.sqrt(dot(vectors, vectors)) - 1.0 / alpha).max())
            yield Check(f"|{name}, largest deviation", error, at_most=length_bound, on=on, reason=reason)
        for name, vectors, alpha, axis in (
            ("left", tangents, material.alpha_x, (1.0, 0.0, 0.0)),
            ("right", binormals, material.alpha_y, (0.0, 1.0, 0.0)),
        ):
            off = vectors - np.array(axis) / alpha[..., None]
            yield DATA.check(
                "{name}: where the stone is level, its vector less that of {color}, largest",
                float(np.abs(off[level]).max()),
                on,
                at_most=length_bound,
                name=name,
                color="red" if axis[0] else "green",
            )
        cosine = dot(normalize(tangents), normalize(binormals))
        yield Check("t.b, largest", float(np.abs(cosine).max()), at_most=angle_bound, on=on, reason=reason)


FIGURE = Figure(
    **DATA.words,
    parameters=OWN,
    methods=(Method("texture environments", scene, MACHINES),),
    acceptance=checks,
)
