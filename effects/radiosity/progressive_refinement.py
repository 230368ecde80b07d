"""H24: diffuse light among surfaces by progressive refinement, as light maps.

Each rectangle of a room is divided into elements, which receive light, and into coarser patches, which send
it. In each step the patch with the most unsent power sends it to all elements,

    B_j += rho_j F_ji dB_i    for each element j,  F_ji from ``form_factors``

and an element's light counts as unsent power of its patch. In a closed room all of a patch's power arrives
somewhere. So a step's factors are divided by their sum, and energy is conserved to rounding.

Source: Heidrich 2001, section 1.4 (a radiosity solution as a texture); Cohen, Chen, Wallace, Greenberg 1988,
A Progressive Refinement Approach to Fast Radiosity Image Generation (elements, patches, order of sending).
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.vectors import cross, dot, normalize
from fixedpipe.effects.radiosity.form_factors import from_rectangle
from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("H24", "diffuse global light as a texture, from a radiosity solution", "1.4"),)

# What is so little above a rectangle tells which of its elements a thing stands on.
_ABOVE = 1.0e-6
# Steps after which a room is given up: one that reflects nearly everything.
_MOST_STEPS = 20000


@dataclass(frozen=True, eq=False)
class Rectangle:
    """A diffuse rectangle that faces across x up.

    name         of its light map
    corner, across, up
                 vectors of three numbers: where it begins, and its edges, at right angles
    reflectance  RGB, 0 to below 1
    elements     columns and rows
    patches      columns and rows, that divide the elements'
    emission     radiosity of its own, RGB [rows, columns, 3] by element, or zero
    """

    name: str
    corner: NDArray[np.float64]
    across: NDArray[np.float64]
    up: NDArray[np.float64]
    reflectance: tuple[float, float, float]
    elements: tuple[int, int]
    patches: tuple[int, int]
    emission: NDArray[np.float64] | float = 0.0

    def __post_init__(self):
        if not all(0.0 <= share < 1.0 for share in self.reflectance):
            raise ValueError(
                f"{self.name} reflects {self.reflectance}; give three numbers from 0 to below 1."
            )
        if any(e < 1 or p < 1 or e % p for e, p in zip(self.elements, self.patches, strict=True)):
            raise ValueError(
                f"{self.name} has {self.elements} elements and {self.patches} patches; give patches that "
                "divide the elements, one at least."
            )
        if not (np.isfinite(self.emission).all() and np.min(self.emission) >= 0.0):
            raise ValueError(f"{self.name} emits a number below 0, NaN or infinity; give numbers from 0 on.")

    @property
    def normal(self):
        """Of length one."""
        return normalize(cross(self.across, self.up))

    @property
    def area(self):
        """In square units."""
        normal = cross(self.across, self.up)
        return float(np.sqrt(dot(normal, normal)))

    def centers(self):
        """The elements' middles: float64 [rows, columns, 3]."""
        columns, rows = self.elements
        s, t = (np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows
        return self.corner + s[None, :, None] * self.across + t[:, None, None] * self.up


@dataclass(frozen=True, eq=False)
class Solution:
    """A solver's result.

    radiosity  by rectangle's name, float64 [rows, columns, 3]: the light that its elements send, in the
               emission's unit
    received   the arriving irradiance by element, in the same unit
    unsent     the power still to be sent, RGB, out of ``emitted``
    steps      how often a patch sent
    sums       the sum of each step's form factors, one in exact arithmetic: float64 [steps]
    """

    radiosity: dict[str, NDArray[np.float64]]
    received: dict[str, NDArray[np.float64]]
    unsent: NDArray[np.float64]
    emitted: NDArray[np.float64]
    steps: int
    sums: NDArray[np.float64]


def _total(values):
    """The sum over the first axis of [n, 3], rounded once, in whatever order."""
    return np.array([math.fsum(values[:, k].tolist()) for k in range(3)])


@dataclass
class _Room:
    """Elements and patches of all rectangles, one after the other."""

    rectangles: tuple
    parts: int
    things: tuple
    factors: dict = field(default_factory=dict)

    def __post_init__(self):
        lists = []
        self.senders, count, patches = [], 0, 0
        for rectangle in self.rectangles:
            (columns, rows), (across, up) = rectangle.elements, rectangle.patches
            number = columns * rows
            each = np.arange(rows)[:, None] // (rows // up) * across + np.arange(columns) // (
                columns // across
            )
            lists.append(
                (
                    rectangle.centers().reshape(-1, 3),
                    np.broadcast_to(rectangle.normal, (number, 3)),
                    np.full(number, rectangle.area / number),
                    np.broadcast_to(np.array(rectangle.reflectance, np.float64), (number, 3)),
                    np.broadcast_to(rectangle.emission, (rows, columns, 3)).reshape(-1, 3),
                    patches + each.ravel(),
                )
            )
            for j in range(up):
                for i in range(across):
                    corner = rectangle.corner + i / across * rectangle.across + j / up * rectangle.up
                    edges = rectangle.across / across, rectangle.up / up
                    self.senders.append(((corner, *edges), max(columns // across, rows // up)))
            count, patches = count + number, patches + across * up
        joined = (np.concatenate(part) for part in zip(*lists, strict=True))
        self.places, self.normals, self.areas, self.reflectance, self.emission, self.patch = joined
        above = self.places + _ABOVE * self.normals
        for thing in self.things:
            self.areas = np.where(thing.holds(above), 0.0, self.areas)
        order = np.argsort(self.patch, kind="stable")
        ends = np.searchsorted(self.patch[order], np.arange(patches + 1))
        self.members = [order[ends[k] : ends[k + 1]] for k in range(patches)]

    def factors_of(self, patch):
        """Form factors from the elements to a patch, and what they added up to before it was made one."""
        if patch not in self.factors:
            rectangle, elements = self.senders[patch]
            areas = self.areas[self.members[patch]]
            # A thing stands on some of the elements: the others are asked one by one.
            parts = elements if (areas == 0.0).any() else self.parts
            found = from_rectangle(self.places, self.normals, rectangle, parts, self.things)
            found = np.where(self.areas > 0.0, found, 0.0)
            arrives, whole = math.fsum((self.areas * found).tolist()), math.fsum(areas.tolist())
            self.factors[patch] = (found * (whole / arrives) if arrives > 0.0 else found, arrives / whole)
        return self.factors[patch]


def solve(rectangles, things=(), *, parts=2, rest=0.002, most=_MOST_STEPS):
    """Diffuse light in a closed room: a Solution.

    rectangles  Rectangles that face inward and leave no gap; their names differ
    things      ``form_factors.Box`` and ``Ball`` that hide them from each other; an element below one
                receives nothing
    parts       that a patch is seen in, along each edge
    rest        the part of the emitted power that may stay unsent
    most        steps at most: 1 and more; few show direct light alone

    Raises ValueError if nothing shines, for names given twice, for invalid numbers, and if more than ``rest``
    is unsent after 20,000 steps.
    """
    names = [rectangle.name for rectangle in rectangles]
    if len(set(names)) < len(names):
        raise ValueError(f"Rectangles of a room have names of their own; these are {', '.join(names)}.")
    if not 0.0 < rest < 1.0:
        raise ValueError(f"The part that stays unsent is {rest!r}; give a number between 0 and 1.")
    for value, what in ((parts, "parts of a patch's edge"), (most, "steps")):
        if isinstance(value, bool) or int(value) != value or value < 1:
            raise ValueError(f"The number of {what} is {value!r}; give a whole number from 1 on.")
    room = _Room(tuple(rectangles), parts, tuple(things))
    areas = room.areas[:, None]
    unsent, received = room.emission.copy(), np.zeros_like(room.emission)
    power = np.stack([_total((areas * unsent)[of]) for of in room.members])
    emitted = _total(power)
    if not emitted.any():
        raise ValueError("Nothing in the room shines; give a rectangle an emission above 0.")
    enough = rest * float(emitted[0] + emitted[1] + emitted[2])
    sums = []
    while len(sums) < most:
        weight = (power[:, 0] + power[:, 1]) + power[:, 2]
        if math.fsum(weight.tolist()) <= enough:
            break
        patch = int(np.argmax(weight))
        factors, total = room.factors_of(patch)
        sums.append(total)
        of = room.members[patch]
        sent = power[patch] / math.fsum(room.areas[of].tolist())
        unsent[of], power[patch] = 0.0, 0.0
        arrived = factors[:, None] * sent
        received += arrived
        unsent += room.reflectance * arrived
        again = areas * (room.reflectance * arrived)
        for k in range(3):
            power[:, k] += np.bincount(room.patch, again[:, k], len(power))
    else:
        if most == _MOST_STEPS:
            raise ValueError(
                f"After {most} steps more than {rest:g} of the power is unsent; let the room reflect less."
            )
    radiosity = room.emission + room.reflectance * received
    found = (_by_name(rectangles, values) for values in (radiosity, received))
    return Solution(*found, _total(power), emitted, len(sums), np.array(sums))


def _by_name(rectangles, values):
    out, first = {}, 0
    for rectangle in rectangles:
        columns, rows = rectangle.elements
        out[rectangle.name] = values[first : first + columns * rows].reshape(rows, columns, 3)
        first += columns * rows
    return out
