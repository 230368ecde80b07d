"""H20: a sphere map, which serves only the view that it was made for, next to a parabolic and a cube map."""

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import arithmetic_check, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments, reflections
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import reflecting
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels

DATA = figure_data(__file__, "H20")

DISCS = "first disc", "second disc"


def scene(profile, size, *, front, behind, environment, edge, photograph):
    """H20: a ball in a ring, the sphere map from both eyes, then both others from the second eye."""
    surface = reflecting.ball_in_ring(size)
    room = photograph.panorama if photograph else reflecting.ENVIRONMENTS[environment]
    edge = reflecting.texels(size) if edge is None else edge
    panels = row_of_panels(4, size)
    views = [
        reflecting.camera(panel, eye) for panel, eye in zip(panels, (front, *(behind,) * 3), strict=True)
    ]
    drawn = (
        reflections.sphere_pass(surface, views[0], bumped_reflections.SPHERE_MAP),
        reflections.sphere_pass(surface, views[1], bumped_reflections.SPHERE_MAP),
        reflections.parabolic_pass(surface, views[2], DISCS, edge),
        reflections.cube_pass(surface, views[3], bumped_reflections.CUBE_MAP),
    )
    out = [
        bumped_reflections.load_sphere_map(edge, views[0], profile, room),
        *reflections.load_discs(DISCS, environments.discs(edge, room), profile),
        bumped_reflections.load_environment(edge, profile, room),
    ]
    for panel, view, draw in zip(panels, views, drawn, strict=True):
        out += (panel.clear(BACKGROUND), *bumped_reflections.backdrop(view), draw)
    return tuple(out)


# For the ideal and the machine: degrees by which what a map shows may be off, RMS, and why.
_MESH = "reflected vectors at the vertices of 48 by 24 facets, iterated; a quarter of slack"
_BYTES = "the same, and directions that are stored in bytes"


def checks(figure, renderer):
    """The direction that a map of directions shows, against the reflection that rays find."""
    size = 128
    panels, values = row_of_panels(4, size), figure.values
    surface = reflecting.ball_in_ring(size)
    front, behind = (
        reflecting.reflections_by_rays(surface, reflecting.camera(panel, values[name]), 0.3)
        for panel, name in ((panels[0], "front"), (panels[1], "behind"))
    )
    backdrops = [
        reflecting.backdrop_by_rays(surface, reflecting.camera(panel, values[name]))
        for panel, name in zip(panels, ("front", *("behind",) * 3), strict=True)
    ]
    for on, (bound, reason) in (
        (Answer.IDEAL, (1.15, _MESH)),
        (Answer.MACHINE, (1.2, _BYTES)),
    ):
        image = renderer.window(on, figure, size, environment="directions", edge=256)

        def off(panel, truth, image=image):
            toward, known = truth
            return root_mean_square(reflecting.degrees_off(panel_of(image, panel), toward)[known])

        for number, name in ((2, "parabolic"), (3, "cube")):
            yield Check(
                f"{name} map from the other eye, against rays, RMS degrees",
                off(number, behind),
                at_most=bound,
                on=on,
                reason=reason,
            )
        yield DATA.check("sphere map from its own eye, against rays, RMS degrees", off(0, front), on)
        behind_all = max(off(k, backdrop) for k, backdrop in enumerate(backdrops))
        yield DATA.check("the environment behind, against rays, largest RMS degrees", behind_all, on)
    yield DATA.check(
        "sphere map from the other eye, against rays, RMS degrees", off(1, behind), Answer.MACHINE
    )
    yield arithmetic_check(
        figure,
        renderer,
        0.003,
        "texels and coordinates are rounded, seen at window bars; twice what is measured",
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "front": word.POSITION((0.0, 0.35, 2.9), "The eye that the sphere map is made for."),
        "behind": word.POSITION((0.9, 0.5, -2.72), "The other eye."),
        "environment": reflecting.ENVIRONMENT,
        "edge": word.FITTED_TEXELS(None, "The edge of a cube map's face, of a disc and of the sphere map."),
        "photograph": own_maps.PANORAMA,
    },
    methods=(Method("REFLECTION_MAP and combiners", scene, COMBINER_MACHINES),),
    acceptance=checks,
)
