"""Primitives whose material changes between their vertices (Material between Begin and End).

- Points, lines, triangles and quads with one material are drawn with it, run by run.
- If one colour of the material differs from vertex to vertex, it becomes the vertices' colour, and the
  primitive is drawn with COLOR_MATERIAL.
- For all others, the machine's own lighting computes the colour of each vertex, and the primitive is drawn
  with these colours. The tally counts them under "lit here". Like given colours, they are cut to bytes.

Source: OpenGL 1.2.1 section 2.13.1, and 2.6.3, which allows Material there. Inferred: nouveau writes the
material's registers between vertices, so the chip lights each vertex with its own material.
"""

from contextlib import contextmanager
from dataclasses import replace
from itertools import groupby, pairwise
from typing import Any

from fixedpipe.pipeline.commands import Mesh
from fixedpipe.pipeline.enums import ProvokingVertex
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.current import draw_vertices
from fixedpipe.pipeline.opengl.lighting import TRACKED
from fixedpipe.pipeline.state import Material

# How many vertices a primitive has, for modes whose primitives are independent of each other.
_SIZES = {tokens.POINTS: 1, tokens.LINES: 2, tokens.TRIANGLES: 3, tokens.QUADS: 4}
_LINES_AND_POINTS = {tokens.POINTS, tokens.LINES, tokens.LINE_STRIP, tokens.LINE_LOOP}
# Places in the vertices that ``Begin`` and ``End`` collect (current.py).
_POSITION, _COLOR, _NORMAL, _SECONDARY, _WEIGHT = 0, 1, 2, 4, 7

_Both = tuple[Material, Material]


def draw_with_changes(
    gl, mode: int, vertices: list[Any], changes: list[tuple[int, Material, Material]]
) -> None:
    """Draw vertices in the form that ``Begin`` and ``End`` collect.

    ``changes``: (first vertex, front material, back material) of each change; the first is at vertex 0.
    """
    if gl.values.section("lighting") is None or not vertices:
        draw_vertices(gl, mode, vertices)
        return
    materials = _of_each(changes, len(vertices))
    size = _SIZES.get(mode)
    if size is None:
        _draw_run(gl, mode, vertices, materials)
        return
    whole = len(vertices) - len(vertices) % size
    starts = range(0, whole, size)
    alike = [len(set(materials[i : i + size])) == 1 for i in starts]
    # Consecutive primitives with one material are drawn together. A primitive with several is drawn alone.
    keys = [materials[i] if one else i for i, one in zip(starts, alike, strict=True)]
    for _, run in groupby(zip(keys, starts, strict=True), key=lambda pair: pair[0]):
        of_run = [start for _, start in run]
        part = slice(of_run[0], of_run[-1] + size)
        _draw_run(gl, mode, vertices[part], materials[part])


def _of_each(changes, count):
    """The materials of each vertex."""
    ends = [first for first, _, _ in changes[1:]] + [count]
    each: list[_Both] = []
    for (first, front, back), end in zip(changes, ends, strict=True):
        each += [(front, back)] * (end - first)
    return each


def _draw_run(gl, mode, vertices, materials: list[_Both]):
    """Draw vertices in the first possible one of the three ways."""
    two_side = gl.values["two_side"] and mode not in _LINES_AND_POINTS
    if not two_side:  # back materials are not read, so they must not make vertices differ
        materials = [(front, materials[0][1]) for front, _ in materials]
    if len(set(materials)) == 1:
        front, back = materials[0]
        with _changed(gl, {"material front": front, "material back": back}):
            draw_vertices(gl, mode, vertices)
        return
    if not _draw_tracking(gl, mode, vertices, materials, two_side):
        _draw_lit(gl, mode, vertices, materials, two_side)


@contextmanager
def _changed(gl, values):
    """Set other values while the block runs."""
    before = {key: gl.values[key] for key in values}
    try:
        for key, value in values.items():
            gl.values.set(key, value)
        yield
    finally:
        for key, value in before.items():
            gl.values.set(key, value)


# --------------------------------------------------------------------------------- by the vertices' colours


def _draw_tracking(gl, mode, vertices, materials, two_side):
    """Draw with COLOR_MATERIAL if possible. Returns whether it was possible."""
    if gl.values[("enabled", tokens.COLOR_MATERIAL)]:
        return False
    found = _tracked(materials, two_side)
    if found is None:
        return False
    face, parameter, colors = found
    colored = [(v[0], color, *v[2:]) for v, color in zip(vertices, colors, strict=True)]
    front, back = materials[0]
    values = {
        "material front": front,
        "material back": back,
        "color_material": (face, parameter),
        ("enabled", tokens.COLOR_MATERIAL): True,
    }
    with _changed(gl, values):
        draw_vertices(gl, mode, colored)
    return True


def _tracked(materials, two_side):
    """(face, parameter, vertices' colours) with which COLOR_MATERIAL makes these materials, or None."""
    faces = [list(side) for side in zip(*materials, strict=True)] if two_side else [[f for f, _ in materials]]
    varying = [len(set(side)) > 1 for side in faces]
    face = (
        tokens.FRONT_AND_BACK if all(varying) and two_side else (tokens.FRONT if varying[0] else tokens.BACK)
    )
    concerned = [side for side, varies in zip(faces, varying, strict=True) if varies]
    for parameter, names in TRACKED.items():
        others = {name: (0.0, 0.0, 0.0, 0.0) for name in names}
        if any(len({replace(material, **others) for material in side}) > 1 for side in concerned):
            continue
        colors = [{getattr(m, name) for m in both for name in names} for both in zip(*concerned, strict=True)]
        if all(len(given) == 1 for given in colors):
            return face, parameter, [given.pop() for given in colors]
    return None


# ---------------------------------------------------------------------------------------------- lit here


def _draw_lit(gl, mode, vertices, materials, two_side):
    """Draw with colours that this module computes."""
    gl.tally.add("lit here", f"{gl.called}: vertices of one primitive with several materials")
    vertex = gl.values.section("vertex")
    lit = _lit(gl.profile, vertex, vertices, materials, two_side)
    values = {
        ("enabled", tokens.LIGHTING): False,
        ("enabled", tokens.COLOR_SUM): vertex.lighting.separate_specular_color,
    }
    with _changed(gl, values):
        if two_side:
            _draw_sides(gl, mode, *lit)
        else:
            draw_vertices(gl, mode, lit[0])


def _lit(profile, vertex, vertices, materials, two_side):
    """The vertices with the machine's front colours and, if ``two_side``, those with its back colours."""
    from fixedpipe.pipeline.vertices.arithmetic import columns_of
    from fixedpipe.pipeline.vertices.colors import eye_normal, vertex_colors
    from fixedpipe.pipeline.vertices.weighting import eye_coordinates, weight_of

    sides: list[list[Any]] = [list(vertices) for _ in range(1 + two_side)]
    for pair in dict.fromkeys(materials):
        places = [i for i, own in enumerate(materials) if own == pair]
        positions, normals, colors, weights = [
            [vertices[i][place] for i in places] for place in (_POSITION, _NORMAL, _COLOR, _WEIGHT)
        ]
        mesh = Mesh(positions, normals=normals, colors=colors, weights=weights)
        lighting = replace(vertex.lighting, front=pair[0], back=pair[1], two_side=two_side)
        own = replace(vertex, lighting=lighting)
        eye = eye_coordinates(own, columns_of(mesh.positions, (0.0, 0.0, 0.0, 1.0)), weight_of(mesh))
        both = vertex_colors(mesh, own, eye, eye_normal(mesh, own), profile)
        for side, columns in zip(sides, both, strict=False):
            for at, i in enumerate(places):
                *primary, r, g, b, a = [float(column[at]) for column in columns]
                v = vertices[i]
                side[i] = (v[0], tuple(primary), *v[2:_SECONDARY], (r, g, b, a), *v[_SECONDARY + 1 :])
    return sides


def _draw_sides(gl, mode, front, back):
    """Draw each polygon with its front colours if it faces the front, and otherwise with its back colours.

    Culling decides this, so the machine's own window coordinates decide it. The order does not change.
    """
    culls = gl.values[("enabled", tokens.CULL_FACE)]
    culled = gl.values["cull_face_mode"] if culls else None
    for primitive, places in _polygons(mode, len(front), gl.values["provoking_vertex"]):
        for face, other, colored in ((tokens.FRONT, tokens.BACK, front), (tokens.BACK, tokens.FRONT, back)):
            if culled not in (face, tokens.FRONT_AND_BACK):
                with _changed(gl, {("enabled", tokens.CULL_FACE): True, "cull_face_mode": other}):
                    draw_vertices(gl, primitive, [colored[i] for i in places])


def _polygons(mode, count, provoking):
    """(primitive, its vertices' numbers) for each polygon. Its provoking vertex is that of the original."""
    last = provoking is ProvokingVertex.LAST
    if mode in _SIZES:
        size = _SIZES[mode]
        return [(mode, range(i, i + size)) for i in range(0, count - count % size, size)]
    if mode == tokens.POLYGON:
        return [(mode, range(count))]
    if mode == tokens.TRIANGLE_FAN:
        fan = pairwise(range(1, count))
        return [(tokens.TRIANGLES, (0, a, b) if last else (a, b, 0)) for a, b in fan]
    if mode == tokens.TRIANGLE_STRIP:
        odd = (lambda i: (i + 1, i, i + 2)) if last else (lambda i: (i, i + 2, i + 1))
        return [(tokens.TRIANGLES, odd(i) if i % 2 else (i, i + 1, i + 2)) for i in range(count - 2)]
    # The last vertex of a quad is the provoking one by either convention, as on the chip. The diagonals stay.
    return [(tokens.QUADS, (i + 2, i, i + 1, i + 3)) for i in range(0, count - 3, 2)]
