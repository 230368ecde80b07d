"""H24: a small room lit by a radiosity solution: direct light, elements, light maps."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.vectors import cosine, cross, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import EDGE, NEAREST
from fixedpipe.effects.radiosity import light_maps, small_room
from fixedpipe.effects.radiosity.progressive_refinement import solve

DATA = figure_data(__file__, "H24")

EYE, CENTER, FIELD_OF_VIEW = (0.0, 0.86, 3.55), (0.0, 0.84, 0.0), 35.6
THINGS = tuple(small_room.BOXES.values())
# The patches of the lamp, which send first.
LAMP_PATCHES = 4


def fitting_elements(size):
    """Elements along a wall's edge for a panel of ``size`` pixels."""
    return 8 if size < 64 else 16 if size < 200 else 32


@lru_cache(maxsize=4)
def solved(elements, left, right):
    """The room's rectangles, the light of the lamp alone, and the whole solution."""
    room = small_room.small_room(elements, left, right)
    # As many parts of the lamp as tell its shadows' edges from steps.
    direct = solve(room, THINGS, parts=4, most=LAMP_PATCHES)
    return room, direct, solve(room, THINGS)


def scene(profile, size, *, elements, left, right, exposure, background):
    """Direct light alone, the solution's elements, and the light maps filtered."""
    elements = fitting_elements(size) if elements is None else elements
    room, direct, solution = solved(elements, tuple(left), tuple(right))
    shown = [rectangle for rectangle in room if rectangle.name != small_room.FRONT]
    out = []
    for title, found in (("direct light", direct), ("light map", solution)):
        maps = light_maps.light_maps(shown, found.radiosity, THINGS, exposure)
        out += light_maps.load(maps, profile, title)
    ways = ("direct light", EDGE), ("light map", NEAREST), ("light map", EDGE)
    for panel, (title, sampler) in zip(row_of_panels(3, size), ways, strict=True):
        view = perspective_view(panel, EYE, CENTER, FIELD_OF_VIEW)
        out += (panel.clear(background), *light_maps.passes(shown, view, sampler, title))
    return tuple(out)


def gathered(room, maps, place, normal, count=64):
    """Irradiance at a point by rays over its hemisphere, dense by the cosine: RGB."""
    around = np.array((1.0, 0.0, 0.0)) if abs(normal[0]) < 0.5 else np.array((0.0, 1.0, 0.0))
    tangent = normalize(cross(around, normal))
    u, v = np.meshgrid((np.arange(count) + 0.5) / count, (np.arange(count) + 0.5) / count)
    radius, angle = np.sqrt(u), 2.0 * np.pi * v
    toward = (
        (radius * cosine(angle))[..., None] * tangent
        + (radius * sine(angle))[..., None] * cross(normal, tangent)
        + np.sqrt(1.0 - u)[..., None] * normal
    )
    return light_maps.seen(room, maps, place + 1.0e-6 * normal, toward).reshape(-1, 3).mean(axis=0)


def _umbra(rectangle, s, t, beside):
    """Which places of a wall the boxes hide from the whole lamp, and all places ``beside`` in s and t too:
    bool [n].
    """
    room = small_room.small_room(8)
    boxes = [face for face in room if face.name.startswith(tuple(small_room.BOXES))]
    (ceiling,) = (wall for wall in room if wall.name == "ceiling")
    hidden = np.ones(len(s), np.bool_)
    for moved_s, moved_t in ((0.0, 0.0), (beside, 0.0), (-beside, 0.0), (0.0, beside), (0.0, -beside)):
        places = (s + moved_s)[:, None] * rectangle.across + (t + moved_t)[:, None] * rectangle.up
        places = rectangle.corner + places
        for a in (0.375, 0.5, 0.625):
            for b in (0.375, 0.5, 0.625):
                lamp = ceiling.corner + a * ceiling.across + b * ceiling.up
                hidden &= light_maps.nearest(boxes, places, lamp - places)[0] >= 0
    return hidden


def _displayed(figure, renderer):
    """What must be seen, in the picture that is displayed."""
    size, elements = figure.size, fitting_elements(figure.size)
    shown = [wall for wall in small_room.small_room(elements) if wall.name != small_room.FRONT]
    names = [wall.name for wall in shown]
    view = perspective_view(row_of_panels(1, size)[0], EYE, CENTER, FIELD_OF_VIEW)
    number, s, t = light_maps.nearest(shown, *primary_rays(view))
    square = number.reshape(size, size)
    # Away from edges, where a pixel may show the other side.
    same = [square == np.roll(square, step, axis) for step in (-1, 1) for axis in (0, 1)]
    number = np.where(np.all(same, axis=0).ravel(), number, -1)
    ceiling, floor = number == names.index("ceiling"), number == names.index("floor")
    # An element and a half from the lamp, and from where light comes: texels are filtered.
    away = 1.5 / elements
    ceiling &= np.maximum(np.abs(s - 0.5), np.abs(t - 0.5)) > 0.125 + away
    floor[floor] = _umbra(shown[names.index("floor")], s[floor], t[floor], away)
    walls = np.isin(number, [names.index(name) for name in ("floor", "left wall", "right wall", "back wall")])
    places = np.stack([c.reshape(size, size) * elements for c in (s, t)], axis=-1)
    # Not at an element's border, where a coordinate's last bit decides.
    element, inner = np.floor(places), np.abs(places % 1.0 - 0.5).max(axis=-1) < 0.4
    same_wall = (square[:, 1:] == square[:, :-1]) & walls.reshape(size, size)[:, 1:]
    same = same_wall & (element[:, 1:] == element[:, :-1]).all(axis=-1)
    inner = same & inner[:, 1:] & inner[:, :-1]
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        direct = panel_of(window, 0).reshape(-1, 3)
        for what, of in (("the ceiling beside the lamp", ceiling), ("shadows on the floor", floor)):
            yield DATA.check("direct light: {what}, brightest", float(direct[of].max()), on, what=what)
        steps, smooth = (np.abs(np.diff(panel_of(window, k), axis=1)).max(axis=-1) for k in (1, 2))
        yield DATA.check("elements: largest step between pixels of one", float(steps[inner].max()), on)
        border = same_wall & ~same
        yield DATA.check(
            "steps at elements' borders, without a filter over with one, mean",
            float(steps[border].mean() / smooth[border].mean()),
            on,
        )


def _continued(texels, below):
    """A map [n, n, 3] whose texels ``below`` something have those of the nearest others."""
    rows, columns = np.nonzero(~below)
    out = texels.copy()
    for j, i in zip(*np.nonzero(below), strict=True):
        nearest = np.argmin((rows - j) ** 2 + (columns - i) ** 2)
        out[j, i] = texels[rows[nearest], columns[nearest]]
    return out


def _foot_checks(figure, renderer):
    """The floor within half an element of the boxes, beside floors whose texels below them are black or full:
    seams.
    """
    size, values = figure.size, figure.values
    elements = fitting_elements(size)
    room, _, solution = solved(elements, values["left"], values["right"])
    shown, floor = [wall for wall in room if wall.name != small_room.FRONT], room[0]
    view = perspective_view(row_of_panels(1, size)[0], EYE, CENTER, FIELD_OF_VIEW)
    number, s, t = light_maps.nearest(shown, *primary_rays(view))
    square = number.reshape(size, size)
    inner = np.all([square == np.roll(square, step, axis) for step in (-1, 1) for axis in (0, 1)], axis=0)
    where = (square == 0) & inner
    s, t = s[where.ravel()], t[where.ravel()]
    places, middles = floor.corner + s[:, None] * floor.across + t[:, None] * floor.up, floor.centers()
    near, below = np.zeros(len(s), np.bool_), np.zeros(middles.shape[:2], np.bool_)
    for box in small_room.BOXES.values():
        beyond, of = (
            (np.abs(box.to_box(p - np.array(box.middle))) - np.array(box.half))[..., ::2].max(axis=-1)
            for p in (places, middles)
        )
        near |= beyond < small_room.HALF_WIDTH / elements
        below |= of < 0.0
    where[where] = near
    place = seen_places.Seen(where, s[near], t[near], np.empty(0))
    texels = np.minimum(values["exposure"] * solution.radiosity["floor"], 1.0)
    maps = _continued(texels, below), *(np.where(below[..., None], full, texels) for full in (0.0, 1.0))
    whole, *seams = (seen_places.looked_up(one, place) for one in maps)
    for on in Answer:
        panel = panel_of(np.clip(renderer.window(on, figure, size), 0.0, 1.0), 2)[where]
        yield DATA.check(
            "floor at the boxes' feet: of what would be seams, the least share that is not there",
            least_share(panel, whole, *seams),
            on,
        )


def _wall_checks(figure, renderer):
    """What direct light on the left, and all light on the right, changes on each rectangle that is seen."""
    size, values = figure.size, figure.values
    room, *lights = solved(fitting_elements(size), values["left"], values["right"])
    shown = [wall for wall in room if wall.name != small_room.FRONT]
    view = perspective_view(row_of_panels(1, size)[0], EYE, CENTER, FIELD_OF_VIEW)
    number, s, t = light_maps.nearest(shown, *primary_rays(view))
    square = number.reshape(size, size)
    inner = np.all([square == np.roll(square, step, axis) for step in (-1, 1) for axis in (0, 1)], axis=0)
    found = []
    for panel, light in zip((0, 2), lights, strict=True):
        for k, wall in enumerate(shown):
            at = inner.ravel() & (number == k)
            texels = np.minimum(values["exposure"] * light.radiosity[wall.name], 1.0)
            whole, turned = (light_maps.look_up(one, s[at], t[at]) for one in (texels, texels[::-1]))
            others = np.broadcast_to(texels.mean(axis=(0, 1)), whole.shape), turned
            # Bytes tell nothing of a change that is nowhere seen.
            others = [one for one in others if at.any() and np.abs(one - whole).max() > 8.0 / 255.0]
            if others:
                found.append((panel, at, whole, *others))
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        panels = {panel: panel_of(window, panel).reshape(-1, 3) for panel in (0, 2)}
        shares = [least_share(panels[panel][at], *of) for panel, at, *of in found]
        yield DATA.check(
            "walls: of what their light maps change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """Energy, light gathered by rays, colours that walls send, and light maps on the machine."""
    yield from _displayed(figure, renderer)
    yield from _foot_checks(figure, renderer)
    yield from _wall_checks(figure, renderer)
    size, values = 128, figure.values
    elements = fitting_elements(size)
    room, direct, solution = solved(elements, values["left"], values["right"])
    absorbed = np.zeros(3)
    for rectangle in room:
        share = rectangle.area / (rectangle.elements[0] * rectangle.elements[1])
        absorbed += share * ((1.0 - np.array(rectangle.reflectance)) * solution.received[rectangle.name]).sum(
            axis=(0, 1)
        )
    yield DATA.check(
        "power absorbed and unsent over power emitted, largest deviation from one",
        np.abs((absorbed + solution.unsent) / solution.emitted - 1.0).max(),
        Answer.IDEAL,
    )
    maps = light_maps.light_maps(room, solution.radiosity, THINGS)
    errors, expected = [], []
    for rectangle in room:
        rows, columns = rectangle.elements[1], rectangle.elements[0]
        for j, i in ((rows // 2, columns // 4), (rows // 4, 3 * columns // 4), (3 * rows // 4, columns // 2)):
            place = rectangle.centers()[j, i]
            if any(thing.holds(place + 1.0e-3 * rectangle.normal) for thing in THINGS):
                continue
            by_rays = gathered(room, maps, place, rectangle.normal)
            errors.append(solution.received[rectangle.name][j, i] - by_rays)
            expected.append(by_rays)
    errors, expected = np.array(errors), np.array(expected)
    yield DATA.check(
        "what elements receive against 4096 rays from them, RMS over the mean",
        root_mean_square(errors) / expected.mean(),
        Answer.IDEAL,
    )
    inner = slice(elements // 4, 3 * elements // 4)
    ceiling, bounced = (found.radiosity["ceiling"][inner, :2].mean() for found in (direct, solution))
    yield DATA.check(
        "the ceiling's light that came by way of other walls, share", 1.0 - ceiling / bounced, Answer.IDEAL
    )
    beside = {
        name: solution.received["floor"][inner, column] for name, column in (("left", 0), ("right", -1))
    }
    ratio = {name: float((of[:, 0] / of[:, 2]).mean()) for name, of in beside.items()}
    yield DATA.check(
        ("red over blue of what the floor receives, beside the left wall over beside the right one"),
        ratio["left"] / ratio["right"],
        Answer.IDEAL,
    )
    view = perspective_view(row_of_panels(1, size)[0], EYE, CENTER, FIELD_OF_VIEW)
    shown = [rectangle for rectangle in room if rectangle.name != small_room.FRONT]
    origins, along = primary_rays(view)
    number, s, t = light_maps.nearest(shown, origins, along)
    # Away from edges, where a pixel may show the other side.
    square = number.reshape(size, size)
    same = [square == np.roll(square, step, axis) for step in (-1, 1) for axis in (0, 1)]
    known = (number >= 0) & np.all(same, axis=0).ravel()
    bright = light_maps.light_maps(shown, solution.radiosity, THINGS, values["exposure"])
    for on in Answer:
        true = np.zeros((len(number), 3))
        for k, rectangle in enumerate(shown):
            of, texels = number == k, bright[rectangle.name]
            # A machine's texels are clamped before they are filtered.
            texels = texels if on is Answer.IDEAL else np.minimum(texels, 1.0)
            true[of] = light_maps.look_up(texels, s[of], t[of])
        image = renderer.window(on, figure, size)[:, 2 * size :].reshape(-1, 3)
        yield DATA.check(
            "light maps against rays that look the solution up, RMS",
            root_mean_square((np.clip(image, 0.0, 1.0) - np.clip(true, 0.0, 1.0))[known]),
            on,
        )


_REFLECTANCE = word.Several(
    (word.Number(0.0, 0.95),) * 3, what="three numbers from 0 to 0.95, red, green, blue"
)
_WALL = "The reflectance of the wall at the {}."

FIGURE = Figure(
    **DATA.words,
    parameters={
        "elements": word.of(
            word.Maybe(word.Choice({str(n): n for n in (8, 16, 32, 64)}), "as many as fit the panel"),
            None,
            "Elements along a wall's edge.",
        ),
        "left": word.of(_REFLECTANCE, (0.68, 0.2, 0.12), _WALL.format("left"), word.FULL),
        "right": word.of(_REFLECTANCE, (0.12, 0.36, 0.52), _WALL.format("right"), word.FULL),
        "exposure": word.NUMBER(1.2, "What the solution is multiplied by.", low=0.01, high=100.0),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("light maps, one texture unit", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
