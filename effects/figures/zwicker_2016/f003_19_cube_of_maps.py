"""F003-19: a point light in a room: one shadow map's field of view, and a cube of six maps."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.effects.scenes import lit_room
from fixedpipe.effects.scenes.objects_and_lamps import detail_of
from fixedpipe.effects.shadows import cube_of_maps, parted_shadow_maps
from fixedpipe.effects.shadows.lit_scene import SceneShading, draw_object, map_edge

DATA = figure_data(__file__, "F003-19")

CHECKED_SIZE = 256
# Segments of what is round, and pieces of each piece of the vase's side: facets of two pixels at most.
# At 32 pixels, where the plain-Python specification draws, the scene's own are enough.
ROUND, PIECES = 96, 6
# Of the faces +x, -x, +y, -y, +z, -z.
TINTS = (
    *((0.95, 0.35, 0.30), (0.25, 0.75, 0.85), (0.40, 0.80, 0.30)),
    *((0.80, 0.35, 0.80), (0.35, 0.42, 0.90), (0.95, 0.85, 0.25)),
)


# Half the edge of the cube that is drawn round the lamp, and the colour of its lines.
_CUBE, _LINES = 0.62, (1.0, 0.97, 0.72)


def _room(size):
    """The room for panels of ``size`` pixels, its vase smooth."""
    return lit_room.lit_room(detail_of(size)) if size < 64 else lit_room.lit_room(ROUND, PIECES)


def frustum_lines(face, reach):
    """The field of view of a face's map as lines in world coordinates: from the lamp to the corners of a
    square ``reach`` before it, and the square; a list of float64 [2 or 5, 3].
    """
    axis, sign = cube_of_maps.FACES.index(face) // 2, 1.0 if face[0] == "+" else -1.0
    corners = np.array([np.insert(np.array(c, float), axis, sign) for c in _SQUARE]) * reach
    lamp = np.array(lit_room.LAMP)
    return [*(np.stack([lamp, lamp + c]) for c in corners[:-1]), lamp + corners]


_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))


def _over(view, number, one, frusta):
    """What a panel shows over the room: where the light is, and lines that bound fields of view."""
    out = [draw_object("where the light is", lit_room.bulb(), view, depth_test=FIRST_PASS)]
    if frusta and number < 2:
        faces, reach = ((one,), _to_wall(one)) if number == 0 else (cube_of_maps.FACES, _CUBE)
        lines = [line for face in faces for line in frustum_lines(face, reach)]
        out.append(drawing.strokes("the maps' fields of view", view, lines, _LINES, width=0.8, alpha=0.8))
    return out


def scene(profile, size, *, shading, ratio, one, background, frusta):
    """F003-19: a room lit through one map, through six, and which part each of them lights."""
    room, row, edge = _room(size), row_of_panels(3, size), map_edge(size, ratio)
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
            out += _over(view, number, one, frusta)
    return tuple(out)


def _to_wall(face):
    """How far the lamp is from the wall, floor or ceiling that a face's map looks at."""
    ends = (
        (lit_room.HALF_WIDTH, -lit_room.HALF_WIDTH),
        (lit_room.HEIGHT, 0.0),
        (lit_room.FRONT, lit_room.BACK),
    )
    axis = cube_of_maps.FACES.index(face) // 2
    return abs(ends[axis][face[0] == "-"] - lit_room.LAMP[axis])


@lru_cache(maxsize=2)
def truth(size):
    """What rays say of a panel of ``size`` pixels: agreement.Truth."""
    view = lit_room.lit_room_view(Panel(0, 0, size, size))
    room = _room(size)
    return agreement.truth_of(room, view, cube_of_maps.face_lamp(lit_room.LAMP, "-z", 0.05, 10.0))


def checks(figure, renderer):
    """The six maps' shadows against rays, map by map, and what one map lights."""
    size = CHECKED_SIZE
    rays, edge = truth(size), map_edge(size, figure.values["ratio"])
    parts = parted_shadow_maps.parts_of_cube(_room(size), lit_room.LAMP, rays.view, edge)
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
    _, plain, tinted = np.split(renderer.machine_window(figure, size, frusta=False), 3, axis=1)
    # A highlight is white, whatever a surface's tint.
    objects = _room(size).objects
    dull = np.array([thing.specular == 0.0 for thing in objects])[rays.shown.object] & rays.shown.something
    dull &= ~agreement.silhouettes(rays) & ~_beside_another(face) & (plain.max(axis=-1) < 1.0)
    colors = np.array([thing.color for thing in objects])
    mixed = [[parted_shadow_maps.tinted_color(color, tint) for tint in TINTS] for color in colors]
    ratio = np.array(mixed)[rays.shown.object, face] / colors[rays.shown.object]
    off = (np.abs(tinted - plain * ratio) / (1.0 + ratio)).max(axis=-1)[dull]
    return (
        DATA.check(
            "tinted: pixels with the second picture's light on their map's tint",
            float((off <= 1.25 / 255.0).mean()),
            Answer.MACHINE,
        ),
        *(
            DATA.check("pixels that agree with rays, map {name}", f.agreeing, Answer.MACHINE, name=name)
            for name, f in zip(cube_of_maps.FACES, found, strict=True)
        ),
        DATA.check(
            "pixels that differ from rays without a reason",
            float(sum(f.other for f in found)),
            Answer.MACHINE,
        ),
        DATA.check(
            "pixels where two maps meet that agree with rays",
            float((kinds[meeting] == agreement.AGREES).mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "one map: pixels lit beyond its field of view",
            float((one & ~inside & away).sum()),
            Answer.MACHINE,
        ),
        DATA.check(
            "one map: pixels of its field of view unlike those of six maps",
            float((one != six)[inside & away].sum()),
            Answer.MACHINE,
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


def reference(size, *, shading, ratio, one, background, frusta):
    """The room's shadows by rays; in the first panel only within one map's field of view."""
    room, row = _room(size), row_of_panels(3, size)
    view = lit_room.lit_room_view(row[0])
    lamp = cube_of_maps.face_lamp(lit_room.LAMP, one, 0.05, 10.0)
    parts = parted_shadow_maps.parts_of_cube(room, lit_room.LAMP, view, map_edge(size, ratio))

    def inside(points):
        return cube_of_maps.face_of(points - np.array(lit_room.LAMP)) == cube_of_maps.FACES.index(one)

    tinted = tuple(
        (part.planes, parted_shadow_maps.tinted(room, tint)) for part, tint in zip(parts, TINTS, strict=True)
    )
    ground = background if shading is SceneShading.LIT else (0.0, 0.0, 0.0)
    shots = [
        shadow_reference.Shot(room, view, (lamp,), ground, shading, reached=inside),
        shadow_reference.Shot(room, view, (lamp,), ground, shading),
        shadow_reference.Shot(room, view, (lamp,), ground, shading, parts=tinted),
    ]
    picture = shadow_reference.row(size, shots)
    if shading is not SceneShading.LIT:
        return picture
    drawn = [
        c
        for number, panel in enumerate(row)
        for c in _over(lit_room.lit_room_view(panel), number, one, frusta)
    ]
    return shadow_reference.overlaid(picture, drawn)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(2.0),
        "one": word.of(
            word.Choice({face: face for face in cube_of_maps.FACES}),
            "-z",
            "The face whose map alone lights the first panel.",
        ),
        "background": word.BACKDROP(BACKGROUND),
        "frusta": word.of(word.Flag(), True, "Whether lines show the maps' fields of view."),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(Method("depth textures and clip planes", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
    reference=reference,
)
