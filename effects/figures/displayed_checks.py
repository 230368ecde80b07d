"""The checks of every figure's displayed picture, besides the figure's own."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Check
from fixedpipe.effects.acceptance.parts import parts_check
from fixedpipe.effects.diagrams.checks import letters_check
from fixedpipe.pipeline.profiles import PROFILES

if TYPE_CHECKING:
    from fixedpipe.effects.figures.figure import Figure, Renderer

# Inferred: corners are snapped to a sixteenth of a pixel, which decides beside an outline, a shadow's edge or
# a texel's border alone. With one such edge in two pixels, that is one pixel in sixteen at most.
_LEAST_ALIKE = 15.0 / 16.0


def displayed_checks(figure: "Figure", renderer: "Renderer") -> Iterator[Check]:
    """The Checks of a figure's displayed picture, in its own size.

    - pixels of the panels in ``figure.compared`` show what the figure's reference has there;
    - the picture changes where one of ``figure.parts`` is left out, on the first machine of each method: the
      others draw the same Draws;
    - letters can be read.
    """
    if figure.compared:
        true = seen_places.of_reference(figure, renderer.method)
        for on, share in seen_places.shares_alike(figure, renderer, true):
            yield Check(
                "pixels that show what the reference has within 8/255, the least of the compared panels",
                share,
                at_least=_LEAST_ALIKE,
                on=on,
                reason="corners are snapped to 1/16 pixel: an edge in two pixels changes one in sixteen",
            )
    if figure.parts and renderer.profile is PROFILES[renderer.method.machines[0]]:
        yield parts_check(figure, renderer)
    yield from letters_check(figure, renderer)
