"""The sides of the view volume (OpenGL 1.2.1 section 2.11), which are the viewport's in the window.

Filled polygons are not cut there. Cutting would leave the part of a polygon that lies in the viewport. The
viewport's sides run between pixels, so a pixel's middle lies in that part if it lies in the polygon and in
the viewport. Polygons are therefore drawn in the viewport alone, as by a scissor box, and no bit inside
changes.

Points, lines, and polygons' outlines may draw pixels beyond the viewport. So lines and outlined polygons are
cut by the planes of the view volume, and a point whose middle lies outside is left out.
"""

from dataclasses import replace
from functools import lru_cache

from fixedpipe.pipeline.enums import PolygonMode, VertexStage
from fixedpipe.pipeline.state import Scissor

_known: dict = {}  # by a state's identity and the framebuffer's size: that state, and what stands for it
_MOST = 4096


def is_filled(mesh, polygon):
    """Whether a mesh is drawn as filled polygons alone."""
    both = polygon.front_mode, polygon.back_mode
    return mesh.primitive.is_polygons and both == (PolygonMode.FILL, PolygonMode.FILL)


def has_sides(vertex):
    """Whether a vertex state has a view volume. A vertex program's results and a composite matrix's are the
    bare chip's: window coordinates, which it does not clip at the sides. Measured: off-screen vertices are
    left alone (tex_diff_pers captures).
    """
    return vertex.stage == VertexStage.FIXED_FUNCTION and vertex.composite is None


def within_viewport(mesh, state, width, height):
    """The state in which filled polygons are drawn in the viewport alone: a PassState whose scissor box is
    the part of its own that lies in the viewport. It is ``state`` itself where that changes nothing, and for
    one state and size always the same object.

    ``width``, ``height``: of the framebuffer, pixels.
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
    """One object for equal boxes: rows of a pass are kept by it."""
    return Scissor(*box)
