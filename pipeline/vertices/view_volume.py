"""The sides of the view volume (OpenGL 1.2.1 section 2.11), which are the viewport's in the window.

Clipping a filled polygon there leaves the part of it inside the viewport. The viewport's sides run between
pixels, so a pixel's middle lies in that part if it lies in the polygon and in the viewport. A scissor box
around the viewport therefore replaces the clipping, and no bit inside changes.

Points, lines and polygons' outlines may draw pixels beyond the viewport. So the planes of the view volume
clip lines and outlined polygons, and a point whose middle lies outside is discarded.
"""

from dataclasses import replace
from functools import lru_cache

from fixedpipe.pipeline.enums import PolygonMode, VertexStage
from fixedpipe.pipeline.state import Scissor

_known: dict = {}  # by a state's identity and the framebuffer's size: that state, and its replacement
_MOST = 4096


def is_filled(mesh, polygon):
    """Whether a mesh is drawn only as filled polygons."""
    both = polygon.front_mode, polygon.back_mode
    return mesh.primitive.is_polygons and both == (PolygonMode.FILL, PolygonMode.FILL)


def has_sides(vertex):
    """Whether the sides of the view volume clip what a vertex state draws.

    A vertex program's results, and a composite matrix's, are window coordinates of the bare chip, which does
    not clip them at the sides. Measured: off-screen vertices are left alone (tex_diff_pers captures).
    """
    return vertex.stage == VertexStage.FIXED_FUNCTION and vertex.composite is None


def within_viewport(mesh, state, width, height):
    """The PassState that draws filled polygons inside the viewport alone.

    Its scissor box is the intersection of the state's own with the viewport. Where nothing changes, the
    result is ``state`` itself. For one state and size it is always the same object. ``width`` and ``height``
    are the framebuffer's, in pixels.
    """
    viewport = state.vertex.viewport
    if viewport.x == viewport.y == 0 and viewport.width is None is viewport.height:
        return state
    if not is_filled(mesh, state.polygon):
        return state
    key = id(state), width, height
    found = _known.get(key)
    if found is None:
        if len(_known) >= _MOST:
            _known.clear()
        found = _known[key] = state, _confined(state, width, height)
    return found[1]


def _confined(state, width, height):
    viewport, scissor = state.vertex.viewport, state.scissor
    right = viewport.x + (width if viewport.width is None else viewport.width)
    top = viewport.y + (height if viewport.height is None else viewport.height)
    own = (0, 0, width, height)
    if scissor is not None:
        own = scissor.x, scissor.y, scissor.x + scissor.width, scissor.y + scissor.height
    left, bottom = max(viewport.x, own[0]), max(viewport.y, own[1])
    box = left, bottom, max(left, min(right, own[2])), max(bottom, min(top, own[3]))
    if box == own:
        return state
    return replace(state, scissor=_scissor(left, bottom, box[2] - left, box[3] - bottom))


@lru_cache(1024)
def _scissor(*box):
    """One object for equal boxes, because the rows of a pass are cached by its identity."""
    return Scissor(*box)
