"""F003-19: a point light in a room: one shadow map's field of view, and a cube of six maps."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.effects.scenes import lit_room
from fixedpipe.effects.scenes.objects_and_lamps import detail_of
from fixedpipe.effects.shadows import cube_of_maps, parted_shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading, draw_object, map_edge

CHECKED_SIZE = 256
# Of the faces +x, -x, +y, -y, +z, -z.
TINTS = (
    (1.0, 0.60, 0.56), (0.56, 0.95, 1.0), (0.62, 1.0, 0.56),
    (1.0, 0.62, 1.0), (0.62, 0.66, 1.0), (1.0, 0.96, 0.50),
)  # fmt: skip


def scene(profile, size, *, shading, ratio, one, background):
    """F003-19: a room lit through one map, through six, and which of them lights what."""
    room, row, edge = lit_room.lit_room(detail_of(size)), row_of_panels(3, size), map_edge(size, ratio)
    parts = [
        parted_shadow_maps.parts_of_cube(room, lit_room.LAMP, lit_room.lit_room_view(p), edge) for p in row
    ]
    lamp = parts[0][0].camera
    out = [*parted_shadow_maps.store_parts(parts[0], room, edge, (3 * size, size))]
    for number, (panel, of_panel) in enumerate(zip(row, parts, strict=True)):
        view = lit_room.lit_room_view(panel)
        out += (
            panel.clear(background if shading is SceneShading.LIT else (0.0, 0.0, 0.0)),
            *parted_shadow_maps.parted_passes(
                of_panel,
                room,
                view,
                lamp,
                profile,
                shading,
                tints=TINTS if number == 2 else None,
                lit=(f"shadow map {one}",) if number == 0 else None,
            ),
        )
        if shading is SceneShading.LIT:
            out.append(draw_object("where the light is", lit_room.bulb(), view, depth_test=FIRST_PASS))
    return tuple(out)


@lru_cache(maxsize=2)
def truth(size):
    """What rays say of a panel of ``size`` pixels: agreement.Truth."""
    view = lit_room.lit_room_view(Panel(0, 0, size, size))
    room = lit_room.lit_room(detail_of(size))
    return agreement.truth_of(room, view, cube_of_maps.face_lamp(lit_room.LAMP, "-z", 0.05, 10.0))


def checks(figure, renderer):
    """The six maps' shadows against rays, map by map, and what one map lights."""
    size = CHECKED_SIZE
    rays, edge = truth(size), map_edge(size, figure.values["ratio"])
    parts = parted_shadow_maps.parts_of_cube(
        lit_room.lit_room(detail_of(size)), lit_room.LAMP, rays.view, edge
    )
    picture = agreement.lit_mask(renderer.machine_window(figure, size, shading=SceneShading.MASK))
    one, six = picture[:, :size], picture[:, size : 2 * size]
    to_light = np.array(lit_room.LAMP) - rays.shown.points
    facing = (rays.shown.normals * to_light).sum(axis=-1) > 0.0
    face = cube_of_maps.face_of(-to_light)
    found = []
    for k, part in enumerate(parts):
        here = facing & (face == k)
        found.append(agreement.compare(six, replace(rays, lamp=part.camera), map_edge=edge, where=here))
    kinds = np.max([f.kinds for f in found], axis=0)
    meeting = _beside_another(face) & (kinds != agreement.NOT_COMPARED)
    inside = face == cube_of_maps.FACES.index(figure.values["one"])
    away = facing & ~agreement.silhouettes(rays) & ~_beside_another(face)
    _, plain, tinted = np.split(renderer.machine_window(figure, size), 3, axis=1)
    # A highlight is white, whatever a surface's tint.
    objects = lit_room.lit_room(detail_of(size)).objects
    dull = np.array([thing.specular == 0.0 for thing in objects])[rays.shown.object] & rays.shown.something
    dull &= ~agreement.silhouettes(rays) & ~_beside_another(face) & (plain.max(axis=-1) < 1.0)
    off = np.abs(tinted - plain * np.array(TINTS)[face]).max(axis=-1)[dull]
    return (
        Check(
            "tinted: pixels of the second picture's colours times their map's tint",
            float((off <= 2.5 / 255.0).mean()),
            at_least=0.999,
            on=Answer.MACHINE,
            reason="the same light and shadows; colours without a light and with it are rounded each; a "
            "bulb and what the lamp's light makes of a neighbour's outline are the rest",
        ),
        *(
            Check(
                f"pixels that agree with rays, map {name}",
                f.agreeing,
                at_least=0.993,
                on=Answer.MACHINE,
                reason="the catalogue's, of those that face the light; the rest lies along shadows' edges",
            )
            for name, f in zip(cube_of_maps.FACES, found, strict=True)
        ),
        Check(
            "pixels that differ from rays without a reason",
            float(sum(f.other for f in found)),
            at_most=4.0,
            on=Answer.MACHINE,
            reason="of 59149; measured 1, on the beam below the ceiling",
        ),
        Check(
            "pixels where two maps meet that agree with rays",
            float((kinds[meeting] == agreement.AGREES).mean()),
            at_least=0.99,
            on=Answer.MACHINE,
            reason="no line of light or shadow where the cube's faces meet; measured 0.994 of 2000",
        ),
        Check(
            "one map: pixels lit beyond its field of view",
            float((one & ~inside & away).sum()),
            at_most=0.0,
            on=Answer.MACHINE,
            reason="away from outlines and from where two maps meet",
        ),
        Check(
            "one map: pixels of its field of view unlike those of six maps",
            float((one != six)[inside & away].sum()),
            at_most=0.0,
            on=Answer.MACHINE,
            reason="it is one of the six",
        ),
    )


def _beside_another(face):
    """Pixels with a pixel of another face above, below, left or right of them: bool [h, w]."""
    out = np.zeros(face.shape, np.bool_)
    for axis in (0, 1):
        changes = np.diff(face, axis=axis) != 0
        before, after = ([slice(None)] * 2 for _ in range(2))
        before[axis], after[axis] = slice(None, -1), slice(1, None)
        out[tuple(before)] |= changes
        out[tuple(after)] |= changes
    return out


FIGURE = Figure(
    id="F003-19",
    title="A cube of six shadow maps",
    caption=(
        "A lamp in the middle of a room, its front wall left out. Left the field of view of one shadow map, "
        "90 degrees wide; middle six of them, arranged in a cube; right the parts of the room that each "
        "lights are tinted."
    ),
    must_see=(
        "Left only the back wall, and what is before it, has light, inside a square. In the middle every "
        "wall, the floor and the ceiling have light and shadows, without a seam or a line of light where two "
        "maps meet: those lines are seen right."
    ),
    source="Zwicker2016",
    techniques=("Z11",),
    panels=("one map, 90 degrees", "cube of six", "what each lights"),
    size=384,
    parameters={
        "ratio": word.RATIO(2.0),
        "one": word.of(
            word.Choice({face: face for face in cube_of_maps.FACES}),
            "-z",
            "The face whose map alone lights the first panel.",
        ),
        "background": word.BACKDROP(BACKGROUND),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth textures and clip planes", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
