"""K11: material textures in the local frame, next to the same textures baked in world coordinates."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.brushed_sphere import COMPARED
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, material_textures
from fixedpipe.effects.reflectance.material_textures import Brushing

DATA = figure_data(__file__, "K11")


# Texels of the material, and half the height of what a panel shows; the sphere's radius is one.
COLUMNS, ROWS, HALF_HEIGHT = 512, 256, 1.1


def _material(alpha_x, alpha_y, spread):
    return material_textures.brushed(
        COLUMNS, ROWS, Brushing.ALONG_S, alpha_x=alpha_x, alpha_y=alpha_y, spread=spread, depth=0.0
    )


def scene(
    profile, size, *, spread, alpha_x, alpha_y, slices, stacks, light, diffuse, ambient, specular, background
):
    """K11: a brushed sphere with material textures in the local frame (left) and baked in the global frame
    (right).
    """
    material = _material(alpha_x, alpha_y, spread)
    normals, tangents, binormals = surfaces.sphere_frames(*height_fields.texel_centers(COLUMNS, ROWS))
    baked = anisotropic_blinn_phong.bake(material, normals, tangents, binormals)
    surface, toward, out = surfaces.sphere(slices, stacks), Light(light), []
    local, local_names = material_textures.load(material, "local frame", profile)
    in_world, world_names = material_textures.load(baked, "global frame", profile)
    for panel, names, is_global in zip(
        row_of_panels(2, size), (local_names, world_names), (False, True), strict=True
    ):
        view = orthographic_view(panel, half_height=HALF_HEIGHT)
        out += (
            panel.clear(background),
            *(in_world if is_global else local),
            *diffuse_bump.diffuse_pass(
                surface, local_names.normal, view, toward, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(
                surface, names, view, toward, profile, specular=specular, global_frame=is_global
            ),
        )
    return tuple(out)


def _displayed_checks(figure, renderer):
    """Both displayed spheres beside spheres whose tangents or binormals have no strokes."""
    size, values = figure.size, figure.values
    fields = material_reference.fields(
        _material(*(values[name] for name in ("alpha_x", "alpha_y", "spread")))
    )
    seen = seen_places.sphere(size, 1.0 / HALF_HEIGHT, (), COMPARED)
    # There is no relief, so nothing tells normals from their mean.
    whole, _, *without = material_reference.pictures(fields, seen, values)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        shares = [
            material_reference.least_share(panel_of(window, k)[seen.where], whole, *without) for k in (0, 1)
        ]
        yield DATA.check(
            "of what single texels of a material texture change, the least share that is seen",
            min(shares),
            on,
        )


def checks(figure, renderer):
    """Both frames give the same picture, which is the brushed sphere's."""
    yield from _displayed_checks(figure, renderer)
    size = 256
    for on in Answer:
        image = renderer.window(on, figure, size)
        difference_of_frames = np.clip(image[:, :size], 0.0, 1.0) - np.clip(image[:, size:], 0.0, 1.0)
        yield DATA.check("RMS of local - global frame", root_mean_square(difference_of_frames), on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "spread": word.SPREAD(8.0),
        "alpha_x": word.ALPHA_X(0.3),
        "alpha_y": word.ALPHA_Y(1.0),
        "slices": word.SLICES(50),
        "stacks": word.STACKS(26),
        "light": word.LIGHT((0.35, 0.45, 0.82)),
        "diffuse": word.DIFFUSE((0.30, 0.17, 0.10)),
        "ambient": word.AMBIENT((0.04, 0.02, 0.02)),
        "specular": word.SPECULAR((1.0, 0.82, 0.68)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("register combiners", scene, COMBINER_MACHINES),),
    acceptance=checks,
)
