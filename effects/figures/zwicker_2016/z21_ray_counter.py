"""Z21: the ray counter of shadow volumes, drawn."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import BLUE, GREEN, INK, RED, YELLOW
from fixedpipe.effects.diagrams.flatland import Shape, crossings, first_hit, is_visible, shadow_volume
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DIAGRAM_MACHINES, Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, row_of_panels

DATA = figure_data(__file__, "Z21")

LIGHT, EYE = (-0.35, 0.88), (-0.90, 0.40)
OBJECTS = (
    Shape("left box", ((-0.42, 0.30), (-0.24, 0.30), (-0.24, 0.46), (-0.42, 0.46))),
    Shape("right box", ((-0.02, 0.22), (0.20, 0.22), (0.20, 0.40), (-0.02, 0.40))),
    Shape("wedge", ((0.40, -0.28), (0.70, -0.24), (0.52, -0.06))),
)
FLOOR = Shape("floor", ((-0.98, -0.84), (0.98, -0.84), (0.98, -0.72), (-0.98, -0.72)))
# How far the silhouettes are extruded: below the floor.
_LENGTH = 4.0
VOLUMES = tuple(shadow_volume(shape, LIGHT, _LENGTH) for shape in OBJECTS)
# Where on the floor the rays of the diagram end, and where labels are at their crossings: as ``align``.
_AIMS = (
    ((-0.76, -0.72), (0, -1)),
    ((-0.33, -0.72), (1, 0)),
    ((0.20, -0.72), (0, 1)),
    ((0.86, -0.72), (0, -1)),
)


def count(towards):
    """A ray from the eye: the point that it hits, and the crossings of shadow volumes before that point, in
    order.

    The counter at the hit is the sum of +1 for each crossing that enters and -1 for each that leaves.
    """
    hit = first_hit(EYE, towards, (*OBJECTS, FLOOR))
    if hit is None:
        return None, ()
    before = tuple(c for c in crossings(EYE, towards, VOLUMES) if c.parameter < hit.parameter - 1e-9)
    return hit, before


def counter(before):
    """The counter after crossings."""
    return sum(1 if c.enters else -1 for c in before)


def _inside_floor(volume):
    """What is drawn of a volume: down to the floor, where its sides end."""
    corners = list(volume.corners)
    for k in (-1, -2):
        near = corners[0] if k == -1 else corners[-3]
        far = corners[k]
        part = (near[1] + 0.72) / (near[1] - far[1])
        corners[k] = (near[0] + (far[0] - near[0]) * part, -0.72)
    return corners


def scene(profile, size, *, background):
    """Shadow volumes seen from the side, and four rays from the eye with what their counters do."""
    (panel,) = row_of_panels(1, size)
    view = drawing.sheet(panel)
    drawn = [_inside_floor(volume) for volume in VOLUMES]
    out = [
        panel.clear(background),
        drawing.load_font(),
        *(
            drawing.polygon(volume.name, view, corners, BLUE, alpha=0.28)
            for volume, corners in zip(VOLUMES, drawn, strict=True)
        ),
        drawing.strokes(
            "edges of the volumes",
            view,
            [[a[0], a[-1]] for a in drawn] + [[a[-3], a[-2]] for a in drawn],
            BLUE,
            width=1.0,
        ),
        drawing.strokes(
            "from the light to the silhouettes",
            view,
            [[LIGHT, a[k]] for a in drawn for k in (0, -3)],
            YELLOW,
            width=0.6,
            dash=(3.0, 4.0),
        ),
        drawing.polygon("floor", view, FLOOR.corners, (0.24, 0.24, 0.26)),
        *(drawing.polygon(shape.name, view, shape.corners, (0.52, 0.50, 0.46)) for shape in OBJECTS),
        drawing.dots("light", view, LIGHT, YELLOW, radius=6.0),
        drawing.text("light", view, LIGHT, YELLOW, align=(-1, 0), offset=(10.0, 0.0)),
        drawing.text("eye", view, EYE, INK, align=(0, -1), offset=(0.0, 6.0)),
    ]
    marks = []
    for aim, align in _AIMS:
        hit, before = count(aim)
        out.append(drawing.arrow("ray", view, [EYE, hit.point], INK, width=1.0, head=6.0))
        for c in before:
            color, name = (RED, "+1") if c.enters else (GREEN, "-1")
            marks.append(drawing.dots(f"{name} at {c.shape.name}", view, c.point, color, radius=2.6))
            offset = (-4.0 * align[0], -3.0 * align[1])
            marks.append(
                drawing.text(name, view, c.point, color, align=align, offset=offset, outline=background)
            )
        total = counter(before)
        color, place = RED if total else GREEN, (hit.point[0], -0.78)
        marks.append(drawing.text(f"= {total}", view, place, color))
    out.append(drawing.dots("eye", view, EYE, INK, radius=4.5))
    legend = "counter > 0: in shadow"
    return (*out, *marks, drawing.text(legend, view, (0.0, -0.87), INK, align=(0, 1)))


def checks(figure, renderer):
    """The counter against the points that the light sees, for every ray of the eye; and the drawn marks."""
    angles = np.radians(np.arange(-900, 301) / 10.0 - 0.03)
    rays = [(EYE[0] + float(np.cos(a)), EYE[1] + float(np.sin(a))) for a in angles]
    counts, dark, inside = [], [], []
    for towards in rays:
        hit, before = count(towards)
        if hit is None:
            continue
        counts.append(counter(before))
        # A hair in front of the surface, as the counter is: the volumes begin on it.
        hair = 1e-6
        point = tuple(e + (p - e) * (1.0 - hair) for e, p in zip(EYE, hit.point, strict=True))
        inside.append(sum(volume.contains(point) for volume in VOLUMES))
        dark.append(not is_visible(hit.point, LIGHT, (*OBJECTS, FLOOR)))
    counts, dark, inside = np.array(counts), np.array(dark), np.array(inside)
    totals = [counter(count(aim)[1]) for aim, _ in _AIMS]
    yield DATA.check(
        "rays whose counter is not the number of volumes that the hit is in",
        float((counts != inside).sum()),
        Answer.IDEAL,
        n=len(counts),
    )
    yield DATA.check(
        "rays where counter > 0 and a blocked way to the light differ",
        float(((counts > 0) != dark).sum()),
        Answer.IDEAL,
    )
    yield DATA.check(
        "volumes that the eye is in", float(sum(volume.contains(EYE) for volume in VOLUMES)), Answer.IDEAL
    )
    yield DATA.check("different counters among the diagram's rays", float(len(set(totals))), Answer.IDEAL)
    size = figure.size
    for on in Answer:
        image, wrong = renderer.window(on, figure, size), 0
        for aim, _ in _AIMS:
            for c in count(aim)[1]:
                j, i = (int((v + 1.0) * 0.5 * size) for v in reversed(c.point))
                red, green = image[j, i, :2]
                wrong += (red > green) != c.enters
        yield DATA.check("drawn marks of the wrong sign", float(wrong), on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("diagram", scene, DIAGRAM_MACHINES),),
    acceptance=checks,
)
