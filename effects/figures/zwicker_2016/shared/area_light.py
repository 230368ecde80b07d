"""The parts of F003-13 and F003-14: a light, an occluder and a floor in the plane, and how much of the light
is visible at each point.

All lengths are in a sheet's units, [-1, 1] each way.
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import FAINT, INK, YELLOW

FLOOR, OCCLUDER, LIGHT = -0.66, 0.02, 0.70
FLOOR_HALF_WIDTH = 0.97
# How thick the floor's bar is.
BAR = 0.07
LIT, DARK = (0.92, 0.86, 0.66), (0.08, 0.11, 0.26)


@dataclass(frozen=True)
class Light:
    """``extent``: how wide it is, 0: a point. ``infinite``: its rays are parallel, and ``x`` is how far they
    lean to the left or the right in each unit of height. Otherwise ``x`` is the place of its middle.
    """

    name: str
    x: float = 0.0
    extent: float = 0.0
    infinite: bool = False

    @property
    def ends(self):
        """The x of its left and right end."""
        return self.x - 0.5 * self.extent, self.x + 0.5 * self.extent

    def shadow_of(self, x, end):
        """Where on the floor the ray ends that comes from an end of the light, and grazes the occluder's end
        at ``x``.
        """
        if self.infinite:
            return x - self.x * (OCCLUDER - FLOOR)
        # Similar triangles: the light and the occluder, the occluder and the floor.
        return x + (x - end) * (OCCLUDER - FLOOR) / (LIGHT - OCCLUDER)

    def edges(self, half_width):
        """Four places on the floor, from left to right: where the penumbra begins, the umbra, and the other
        penumbra, and where that ends.

        A light without extent has a penumbra without width.
        """
        left, right = self.ends
        return (
            self.shadow_of(-half_width, right),
            self.shadow_of(-half_width, left),
            self.shadow_of(half_width, right),
            self.shadow_of(half_width, left),
        )

    def visible(self, floor_x, half_width, samples=2048):
        """How much of the light is seen from points of the floor: float64 like ``floor_x``, [0, 1].

        By ``samples`` points of the light, each behind the occluder or not: it knows no similar triangles.
        """
        x = np.asarray(floor_x, np.float64)[..., None]
        if self.infinite:
            crossing = x + self.x * (OCCLUDER - FLOOR) + np.zeros(1)
        else:
            left, right = self.ends
            source = left + (right - left) * (np.arange(samples) + 0.5) / samples
            crossing = x + (source - x) * ((OCCLUDER - FLOOR) / (LIGHT - FLOOR))
        return (np.abs(crossing) > half_width).mean(axis=-1)


def floor_bar(view, light, half_width):
    """The floor as a bar, as bright as the part of the light is that it sees."""
    places = (-FLOOR_HALF_WIDTH, *light.edges(half_width), FLOOR_HALF_WIDTH)
    shades = (LIT, LIT, DARK, DARK, LIT, LIT)
    parts = []
    for name, a, b in zip(
        ("lit", "penumbra", "umbra", "penumbra", "lit"), range(5), range(1, 6), strict=True
    ):
        x0, x1 = places[a], places[b]
        if x1 > x0:
            outline = [(x0, FLOOR - BAR), (x1, FLOOR - BAR), (x1, FLOOR), (x0, FLOOR)]
            colors = [shades[a], shades[b], shades[b], shades[a]]
            parts.append(drawing.polygon(f"floor, {name}", view, outline, colors))
    return tuple(parts)


def regions(view, light, half_width):
    """The light's region, with the shadow's left out and its penumbra fading: polygons under all else."""
    outer_left, inner_left, inner_right, outer_right = light.edges(half_width)
    left, right = light.ends
    if light.infinite:
        # A side that would leave the panel is upright.
        aside = light.x * (0.98 - FLOOR)
        tops = [(max(aside, 0.0) - FLOOR_HALF_WIDTH, 0.98), (min(aside, 0.0) + FLOOR_HALF_WIDTH, 0.98)]
    else:
        tops = [(left, LIGHT), (right, LIGHT)]
    glow, dark = (0.30, 0.27, 0.17), (0.07, 0.09, 0.20)
    out = [
        drawing.polygon(
            "what the light reaches",
            view,
            [(-FLOOR_HALF_WIDTH, FLOOR), (FLOOR_HALF_WIDTH, FLOOR), tops[1], tops[0]],
            glow,
        )
    ]
    for x, outer, inner in ((-half_width, outer_left, inner_left), (half_width, outer_right, inner_right)):
        if outer != inner:
            # In between the colour turns from the lit region's to the umbra's, as the floor's does.
            steps = [outer + (inner - outer) * k / 16 for k in range(17)]
            for k in range(16):
                mix = (k + 0.5) / 16
                color = [g + (d - g) * mix for g, d in zip(glow, dark, strict=True)]
                outline = [(x, OCCLUDER), (steps[k], FLOOR), (steps[k + 1], FLOOR)]
                out.append(drawing.polygon("penumbra", view, outline, color))
    umbra = [(-half_width, OCCLUDER), (inner_left, FLOOR), (inner_right, FLOOR), (half_width, OCCLUDER)]
    out.append(drawing.polygon("umbra", view, umbra, dark))
    return tuple(out)


def rays(view, light, half_width):
    """The rays that bound umbra and penumbra: grazing the occluder's ends, from the light to the floor."""
    lines = []
    for x in (-half_width, half_width):
        for end in sorted(set(light.ends)):
            top = (x + light.x * (0.98 - OCCLUDER), 0.98) if light.infinite else (end, LIGHT)
            lines.append([top, (light.shadow_of(x, end), FLOOR)])
    return drawing.strokes("rays that graze the occluder", view, lines, YELLOW)


def things(view, light, half_width):
    """The light and the occluder."""
    y, thick = OCCLUDER, 0.018
    slab = [
        (-half_width, y - thick),
        (half_width, y - thick),
        (half_width, y + thick),
        (-half_width, y + thick),
    ]
    out = [drawing.polygon("occluder", view, slab, INK)]
    left, right = light.ends
    if light.infinite:
        arrows = (-0.66, -0.46, -0.10, 0.10, 0.52)
        out += [
            drawing.arrow(
                "parallel rays",
                view,
                [(x + light.x * 0.96, 0.96), (x + light.x * 0.70, 0.70)],
                YELLOW,
            )
            for x in arrows
        ]
    elif light.extent:
        bar = [(left, LIGHT), (right, LIGHT), (right, LIGHT + 0.045), (left, LIGHT + 0.045)]
        out.append(drawing.polygon("area light", view, bar, YELLOW))
    else:
        out.append(drawing.dots("point light", view, (light.x, LIGHT), YELLOW, radius=4.5))
    return tuple(out)


def dimension(label, view, ends, align, offset, color=INK):
    """A length: arrows both ways between two points, and its name, in one line or several."""
    (x0, y0), (x1, y1) = ends
    middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
    name = f"length {label}".replace("\n", " ")
    return (
        drawing.arrow(name, view, [middle, (x0, y0)], color, head=5.0, width=1.0),
        drawing.arrow(name, view, [middle, (x1, y1)], color, head=5.0, width=1.0),
        drawing.text(label, view, middle, color, align=align, offset=offset),
    )


def guide(view, points):
    """A thin dashed line that a dimension ends at."""
    return drawing.stroke("guide", view, points, FAINT, width=0.8, dash=drawing.DASH)


def drawn_edges(panel, middle=0.0):
    """``edges`` as a panel's picture [size, size, 3] shows them: where the floor begins to darken, is dark,
    and so on. ``middle``: an x in the umbra.
    """
    size = len(panel)
    step = 2.0 / size
    x = (np.arange(size) + 0.5) * step - 1.0
    row, out = panel[int((FLOOR - BAR / 2 + 1.0) * 0.5 * size), :, 0], []
    # From both ends of the floor to the umbra.
    for side, start, sign in (
        ((x > -FLOOR_HALF_WIDTH) & (x < middle), -FLOOR_HALF_WIDTH, 1.0),
        ((x > middle) & (x < FLOOR_HALF_WIDTH), FLOOR_HALF_WIDTH, -1.0),
    ):
        level = (row[side] - row[side].min()) / (row[side].max() - row[side].min())
        # From a tenth to nine tenths is eight tenths of a ramp.
        width = float(((level > 0.1) & (level < 0.9)).sum()) * step / 0.8
        half_lit = start + sign * float((level > 0.5).sum()) * step
        out += [half_lit - 0.5 * width, half_lit + 0.5 * width]
    return np.array(out)
