"""F000-6: the principle of shadow maps: the lamp's image plane, its depths, and two points compared."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.ray_caster import scene_caster
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.checks import drawn_check
from fixedpipe.effects.diagrams.drawing import BLUE, FAINT, INK, RED, VISIBLE, YELLOW
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, rotation, transform
from fixedpipe.effects.geometry.vectors import cosine, sine
from fixedpipe.effects.geometry.views import BACKGROUND, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, Object, Scene, detail_of, floor
from fixedpipe.effects.shadows.alpha_coded_shadows import MAP, Coding, DepthComponent, store_map
from fixedpipe.effects.shadows.lit_scene import map_edge
from fixedpipe.effects.shadows.shadow_volumes import z_pass
from fixedpipe.pipeline.profiles import IDEAL

DATA = figure_data(__file__, "F000-6")

# The depths themselves, of eight bits, as grey: the map is shown, not compared.
CODING = Coding(component=DepthComponent.RED, bias=0.0)
LAMP, TARGET = (-1.8, 3.3, 2.1), (0.0, 0.15, 0.0)
CAMERA, AIM = (2.0, 1.45, 1.6), (0.2, 0.1, 0.3)
# How far from the lamp its image plane is drawn: any distance gives the same image.
PLANE = 1.6
# The lit point, and the point of the box's top that hides the other.
LIT, HIDING = (0.35, 0.0, 0.95), (0.2, 0.95, -0.2)


def small_scene(size):
    """A box and a ball on a floor."""
    detail = detail_of(size)
    box = surfaces.box(0.7, 0.95, 0.7).rotated(rotation("y", 20.0)).moved(-0.1, 0.475, -0.15)
    ball = surfaces.sphere(detail, detail // 2).scaled(0.34).moved(-1.0, 0.34, 0.35)
    return Scene(
        (
            Object("floor", floor(1.6, detail // 2), (0.60, 0.58, 0.54), closed=False),
            Object("box", box, (0.72, 0.40, 0.26), 0.1),
            Object("ball", ball, (0.30, 0.50, 0.66), 0.4),
        )
    )


# Its planes are just beyond what it sees.
THE_LAMP = Lamp(LAMP, TARGET, near=2.5, far=5.8, field_of_view=40.0)


def hidden_point():
    """Where the ray from the lamp through ``HIDING`` meets the floor."""
    part = LAMP[1] / (LAMP[1] - HIDING[1])
    return tuple(a + (b - a) * part for a, b in zip(LAMP, HIDING, strict=True))


def depth(lamp, point):
    """The linear depth from the lamp: 0 at its near plane, 1 at its far one."""
    return float(sum(a * b for a, b in zip(lamp.depth_plane, (*point, 1.0), strict=True)))


def map_coordinates(lamp, point):
    """(s, t) of the depth map where a point is seen from the lamp."""
    s, t, _, q = transform(lamp.texture_matrix, (*point, 1.0))
    return s / q, t / q


def on_image_plane(lamp, point):
    """Where the ray from the lamp to a point goes through the image plane."""
    z = -transform(lamp.modelview, (*point, 1.0))[2]
    return tuple(a + (b - a) * (PLANE / z) for a, b in zip(lamp.position, point, strict=True))


def _corners(modelview, position, field_of_view, distance):
    """The corners of a camera's image at a distance, lower left first, in world coordinates."""
    half = np.radians(0.5 * field_of_view)
    reach = distance * float(sine(half) / cosine(half))
    side, above, back = (np.array(row[:3]) for row in modelview[:3])
    return [
        tuple(map(float, np.array(position) - back * distance + side * (x * reach) + above * (y * reach)))
        for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
    ]


def image_plane(lamp):
    """The corners of the lamp's image plane, where (s, t) is (0, 0), (1, 0), (1, 1) and (0, 1)."""
    return _corners(lamp.modelview, lamp.position, lamp.field_of_view, PLANE)


def overview(panel):
    """The view of the left panel."""
    return perspective_view(panel, (0.7, 4.6, 9.2), (-0.17, 1.42, 0.3), field_of_view=31.5, radius=5.0)


def _frustum(view, lamp):
    plane = image_plane(lamp)
    far = []
    for corner in plane:
        part = lamp.position[1] / (lamp.position[1] - corner[1])
        far.append(tuple(a + (b - a) * part for a, b in zip(lamp.position, corner, strict=True)))
    return (
        drawing.strokes(
            "the lamp's frustum", view, [[c, f] for c, f in zip(plane, far, strict=True)], FAINT,
            width=0.9, depth_test=VISIBLE,
        ),
        drawing.picture("image plane: the depth map", view, plane, MAP, depth_test=FIRST_PASS),
        drawing.stroke("its edge", view, [*plane, plane[0]], INK, depth_test=VISIBLE),
        drawing.strokes(
            "from the lamp to its image plane", view, [[lamp.position, c] for c in plane], FAINT,
            width=0.9, depth_test=VISIBLE,
        ),
    )  # fmt: skip


def _camera(view, hidden):
    corners = _corners(look_at(CAMERA, AIM), CAMERA, 30.0, 0.55)
    return (
        drawing.strokes("camera", view, [[CAMERA, c] for c in corners], BLUE),
        drawing.stroke("the camera's image", view, [*corners, corners[0]], BLUE),
        drawing.strokes(
            "what the camera sees",
            view,
            [[CAMERA, LIT], [CAMERA, hidden]],
            BLUE,
            width=0.8,
            dash=drawing.DASH,
        ),
        drawing.dots("camera", view, CAMERA, BLUE),
        drawing.text("camera", view, CAMERA, BLUE, align=(0, -1), offset=(-6.0, 22.0)),
    )


def _rays(view, lamp, hidden):
    p, q = on_image_plane(lamp, LIT), on_image_plane(lamp, hidden)
    return (
        drawing.strokes(
            "light", view, [[lamp.position, LIT], [lamp.position, HIDING]], YELLOW, depth_test=VISIBLE
        ),
        drawing.stroke("blocked light", view, [HIDING, hidden], RED, dash=drawing.DASH),
        drawing.dots("on the image plane", view, [p], YELLOW, radius=2.4),
        drawing.dots("on the image plane", view, [q], RED, radius=2.4),
        drawing.dots("nearest on Q's ray", view, HIDING, YELLOW),
        drawing.dots("P", view, LIT, YELLOW),
        drawing.dots("Q", view, hidden, RED),
        drawing.dots("lamp", view, lamp.position, YELLOW, radius=6.0),
    )


def _overview(scene, view, lamp, profile, background):
    hidden = hidden_point()
    return (
        view.panel.clear(background),
        *z_pass(scene, view, lamp, profile),
        *_frustum(view, lamp),
        *_camera(view, hidden),
        *_rays(view, lamp, hidden),
        drawing.text(
            "image plane",
            view,
            image_plane(lamp)[2],
            INK,
            align=(-1, -1),
            offset=(0.0, 4.0),
        ),
        drawing.text("lamp", view, lamp.position, YELLOW, align=(-1, 0), offset=(9.0, 3.0)),
        drawing.text("P", view, LIT, YELLOW, align=(0, 1), offset=(0.0, -4.0), outline=background),
        drawing.text("Q", view, hidden, RED, align=(-1, 1), offset=(3.0, -3.0), outline=background),
    )


def verdict(lamp, name, point, nearest):
    """The comparison in words."""
    own, stored = depth(lamp, point), depth(lamp, nearest)
    if own > stored + 1.0 / 255.0:
        return f"{name}: map {stored:.2f} < depth {own:.2f}\nin shadow"
    return f"{name}: map {stored:.2f} = depth {own:.2f}\nlit"


# Where the right panel has the map.
MAP_LOW, MAP_HALF = -0.52, 0.70


def place(point):
    """Where on the right panel's sheet a point's texel is."""
    s, t = map_coordinates(THE_LAMP, point)
    return MAP_HALF * (2.0 * s - 1.0), MAP_LOW + 2.0 * MAP_HALF * t


def _map_panel(panel, lamp, background):
    view, hidden = drawing.sheet(panel), hidden_point()
    low, half = MAP_LOW, MAP_HALF
    corners = [(-half, low), (half, low), (half, low + 2.0 * half), (-half, low + 2.0 * half)]
    return (
        panel.clear(background),
        drawing.picture("the depth map", view, corners, MAP),
        drawing.stroke("its edge", view, [*corners, corners[0]], INK),
        drawing.dots("P", view, place(LIT), YELLOW),
        drawing.dots("Q", view, place(hidden), RED),
        drawing.text("P", view, place(LIT), YELLOW, align=(1, 0), offset=(-5.0, 0.0), outline=background),
        drawing.text("Q", view, place(hidden), RED, align=(-1, 0), offset=(5.0, 0.0), outline=background),
        drawing.text("depths seen from the lamp", view, (0.0, 0.98), INK, align=(0, 1)),
        drawing.text(
            verdict(lamp, "P", LIT, LIT), view, (0.0, low), YELLOW, align=(0, 1), offset=(0.0, -4.0)
        ),
        drawing.text(verdict(lamp, "Q", hidden, HIDING), view, (0.0, -0.94), RED, align=(0, -1)),
    )


def scene(profile, size, *, map_ratio, background):
    """Left: the scene, the lamp's frustum and its image plane with the depth map. Right: the map."""
    left, right = row_of_panels(2, size)
    things = small_scene(size)
    lamp = THE_LAMP
    return (
        CODING.ramp(profile),
        *store_map(things, lamp, left, map_edge(size, map_ratio), profile, CODING),
        drawing.load_font(),
        *_overview(things, overview(left), lamp, profile, background),
        *_map_panel(right, lamp, background),
    )


def _seen_depths(caster, coordinates):
    """What the lamp sees at (s, t) [n, 2], by rays: the linear depths, 1 where it sees nothing."""
    a, b, _, d = (np.array(corner) for corner in image_plane(THE_LAMP))
    s, t = coordinates[:, :1], coordinates[:, 1:]
    directions = a + s * (b - a) + t * (d - a) - np.array(LAMP)
    distance = caster.nearest(LAMP, directions).distance
    points = np.array(LAMP) + np.where(np.isfinite(distance), distance, 1e3)[:, None] * directions
    plane = np.array(THE_LAMP.depth_plane)
    return np.clip(points @ plane[:3] + plane[3], 0.0, 1.0)


def _marks(size):
    """The dots of P, Q, what hides Q, and where P and Q are on the image plane and the map."""
    left, right = row_of_panels(2, size)
    view, sheet, hidden = overview(left), drawing.sheet(right), hidden_point()
    return (
        (0, view, LIT, YELLOW),
        (0, view, HIDING, YELLOW),
        (0, view, hidden, RED),
        (0, view, on_image_plane(THE_LAMP, LIT), YELLOW),
        (0, view, on_image_plane(THE_LAMP, hidden), RED),
        (1, sheet, place(LIT), YELLOW),
        (1, sheet, place(hidden), RED),
    )


def checks(figure, renderer):
    """P, Q and the map against rays; and that all three pictures of the map show the same depths."""
    size, lamp, hidden = figure.size // 2, THE_LAMP, hidden_point()
    caster = scene_caster(small_scene(size))
    position = np.array(LAMP)
    ways = np.array([LIT, hidden]) - position
    found = caster.nearest(position, ways)
    met = position + found.distance[:, None] * ways
    wanted = np.array([LIT, HIDING])
    yield DATA.check(
        "what the lamp's rays to P and Q meet first - where the diagram says, world units",
        float(np.abs(met - wanted).max()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "(s, t) on the image plane - (s, t) of what is behind it",
        max(
            abs(a - b)
            for point in (LIT, HIDING, hidden, (-1.0, 0.5, 0.3))
            for a, b in zip(
                map_coordinates(lamp, on_image_plane(lamp, point)),
                map_coordinates(lamp, point),
                strict=True,
            )
        ),
        Answer.IDEAL,
    )
    yield DATA.check(
        "(s, t) of the image plane's corners - 0 and 1",
        max(
            abs(a - b)
            for corner, st in zip(image_plane(lamp), ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True)
            for a, b in zip(map_coordinates(lamp, corner), st, strict=True)
        ),
        Answer.IDEAL,
    )
    yield DATA.check(
        "verdicts that are wrong",
        float(not verdict(lamp, "P", LIT, tuple(met[0])).endswith("\nlit"))
        + float(not verdict(lamp, "Q", hidden, tuple(met[1])).endswith("\nin shadow")),
        Answer.IDEAL,
    )
    yield from drawn_check(figure, renderer, _marks(size))
    for on in Answer:
        stored = _stored_map(figure, renderer, on, size)
        edge = len(stored)
        at = [
            stored[int(t * edge), int(s * edge)]
            for s, t in (map_coordinates(lamp, point) for point in (LIT, hidden))
        ]
        yield DATA.check("|P's depth - map|", abs(depth(lamp, LIT) - at[0]), on, at_most=3 / 255)
        yield DATA.check(
            "|depth of what hides Q - map|", abs(depth(lamp, HIDING) - at[1]), on, at_most=3 / 255
        )
        yield DATA.check("Q's depth - map", depth(lamp, hidden) - at[1], on)
        image = renderer.window(on, figure, size)
        for name, places, coordinates, bound, reason in (
            ("on the right", *_places_of_map(size), 0.95, "edges of things, dots and letters are elsewhere"),
            (
                "on the image plane",
                *_places_of_plane(size),
                0.70,
                "two rays, dots and edges of things cover the others",
            ),
        ):
            shown = image[places[:, 1], places[:, 0], 0]
            near = np.abs(shown - _seen_depths(caster, coordinates)) <= 6 / 255
            yield Check(
                f"share of the map {name} that has the depths of rays",
                float(near.mean()),
                at_least=bound,
                on=on,
                reason=reason,
            )


def _stored_map(figure, renderer, on, size):
    """The depths that the frame stores, float64 [edge, edge], bottom row first: what is drawn before the
    font is loaded.
    """
    profile = IDEAL if on is Answer.IDEAL else renderer.profile
    commands = figure.commands(profile, size, renderer.method)
    first = next(k for k, command in enumerate(commands) if command.label.startswith("load the font"))
    edge = map_edge(size, figure.values["map_ratio"])
    dimensions = figure.dimensions(size)
    if on is Answer.IDEAL:
        return renderer.execute_ideal(commands[:first], *dimensions).color[::-1, :, 0][:edge, :edge]
    framebuffer = renderer.execute(commands[:first], profile, *dimensions).framebuffer
    return framebuffer.color[::-1, :, 0][:edge, :edge] / (2.0**framebuffer.color_bits - 1.0)


def _grid(count):
    s, t = np.meshgrid((np.arange(count) + 0.5) / count, (np.arange(count) + 0.5) / count)
    return np.stack([s.ravel(), t.ravel()], axis=-1)


def _places_of_map(size):
    """Pixels of the right panel's map, int64 [n, 2], and their (s, t)."""
    coordinates = _grid(61)
    sheet_x, sheet_y = (
        MAP_HALF * (2.0 * coordinates[:, 0] - 1.0),
        MAP_LOW + 2.0 * MAP_HALF * coordinates[:, 1],
    )
    x = size + np.floor((sheet_x + 1.0) * 0.5 * size).astype(int)
    return np.stack([x, np.floor((sheet_y + 1.0) * 0.5 * size).astype(int)], axis=-1), coordinates


def _places_of_plane(size):
    """Pixels of the left panel's image plane, int64 [n, 2], and their (s, t)."""
    coordinates = _grid(31)
    a, b, _, d = (np.array(corner) for corner in image_plane(THE_LAMP))
    points = a + coordinates[:, :1] * (b - a) + coordinates[:, 1:] * (d - a)
    seen = drawing.project(overview(row_of_panels(2, size)[0]), points)
    return np.floor(seen[:, :2]).astype(int), coordinates


FIGURE = Figure(
    **DATA.words,
    parameters={
        "map_ratio": word.RATIO(
            0.5, "Texels of the depth map for each of the panel's pixels, along an edge."
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
