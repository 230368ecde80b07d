"""The fixed-function vertex stage, one vertex at a time: Python floats are IEEE 754 float64."""

import math
from collections import namedtuple
from dataclasses import dataclass, field
from fractions import Fraction

from fixedpipe.pipeline.enums import (
    Face,
    FogArithmetic,
    FogCoordinateSource,
    FogGeneration,
    LightingArithmetic,
    PrimitiveType,
    ProvokingVertex,
    TexGenMode,
    VertexStage,
    WindowOrigin,
)
from tests.reference import fixed, fog, lighting_unit
from tests.reference.spotlights import cosine_of_degrees

NEAREST_W = 2.0**-100  # Assumed: any small number; without a near plane w stays positive

# What a vertex is on its way to the window; colors: front and back, eight components each (primary RGBA,
# secondary RGBA); coordinates: s, t, r, q of every unit.
Vertex = namedtuple("Vertex", "clip eye colors coordinates fog")
WindowVertex = namedtuple("WindowVertex", "x y z inverse_w colors coordinates fog")


@dataclass
class Assembled:
    """Window triangles in draw order, each (three WindowVertex, the provoking vertex's colors)."""

    triangles: list = field(default_factory=list)
    dropped: int = 0


# ------------------------------------------------------------------------------------------- arithmetic


def divide(a, b):
    """Quotient, also by zero, where Python raises. Source: IEEE 754 (signed infinity, or NaN)."""
    if b != 0:
        return a / b
    if a == 0 or math.isnan(a):
        return math.nan
    return math.copysign(math.inf, math.copysign(1.0, a) * math.copysign(1.0, b))


def weighted_sum(coefficients, values):
    """Terms in order; those with a coefficient of 0 left out. Source: OpenGL 1.2.1 section 2.10 (M v)."""
    terms = [float(c) * v for c, v in zip(coefficients, values, strict=True) if c != 0]
    total = terms[0] if terms else 0.0
    for term in terms[1:]:
        total = total + term
    return total


def transform(matrix, vector):
    """Matrix times vector. Source: OpenGL 1.2.1 section 2.10.2."""
    return [weighted_sum(row, vector) for row in matrix]


def composite_product(matrix, position):
    """The composite matrix times a position. Measured: the transform unit's sums (Lighting_spotlight)."""
    position = [lighting_unit.single(c) for c in position]
    rows = [[lighting_unit.single(c) for c in row] for row in matrix]
    return [float(lighting_unit.transform_dot(position, row)) for row in rows]


def dot(a, b):
    """Dot product of two directions. Source: OpenGL 1.2.1 section 2.13.1."""
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]


def length(v):
    """Length of a direction. Source: OpenGL 1.2.1 section 2.13.1."""
    return math.sqrt(dot(v, v))


def normalize(v):
    """Unit vector. Source: OpenGL 1.2.1 section 2.13.1; Assumed: a vector of length 0 stays as it is."""
    size = length(v)
    return list(v) if size == 0 else [component / size for component in v]


def positive(x):
    """max(x, 0) for lighting's dot products; NaN is 0. Source: OpenGL 1.2.1 section 2.13.1."""
    return x if x > 0 else 0.0


def clamp_color(x):
    """Clamp to [0, 1]; NaN is 0. Source: OpenGL 1.2.1 section 2.13.6."""
    return min(positive(x), 1.0)


def power(x, n):
    """Power for lighting, by n's binary digits. Source: OpenGL 1.2.1 section 2.13.1 (s_rm, s_rli)."""
    exact = Fraction(n)
    whole, fraction = divmod(exact, 1)
    digits = []
    factor = x
    for place in range(int(whole).bit_length()):
        if int(whole) >> place & 1:
            digits.append(factor)
        factor = factor * factor
    factor = x
    while fraction:
        factor = math.sqrt(factor)
        digit, fraction = divmod(2 * fraction, 1)
        if digit:
            digits.append(factor)
    return math.prod(digits[1:], start=digits[0]) if digits else 1.0


# --------------------------------------------------------------------------------------------- assembly


def split_run(primitive, n, provoking):
    """Triangles (a, b, c, provoking) of one Begin/End pair of n vertices.

    Measured: splits and provoking vertices on NV2A; OpenGL 1.2.1 table 2.9 for LAST.
    """
    first = provoking == ProvokingVertex.FIRST
    if primitive == PrimitiveType.TRIANGLES:
        return [(i, i + 1, i + 2, i if first else i + 2) for i in range(0, n - 2, 3)]
    if primitive == PrimitiveType.TRIANGLE_STRIP:
        return [(*strip_triangle(i), i if first else i + 2) for i in range(n - 2)]
    if primitive == PrimitiveType.TRIANGLE_FAN:
        return [(0, i, i + 1, i if first else i + 1) for i in range(1, n - 1)]
    if primitive == PrimitiveType.POLYGON:
        return [(0, i, i + 1, 0) for i in range(1, n - 1)]
    triangles = []
    if primitive == PrimitiveType.QUADS:
        for i in range(0, n - 3, 4):
            triangles += [(i, i + 1, i + 2, i + 3), (i, i + 2, i + 3, i + 3)]
    else:
        for i in range(0, n - 3, 2):
            triangles += [(*strip_triangle(i), i + 3), (*strip_triangle(i + 1), i + 3)]
    return triangles


def strip_triangle(i):
    """Triangle i of a strip, alternately turned. Source: OpenGL 1.2.1 section 2.6.1; Measured: the order."""
    return (i, i + 1, i + 2) if i % 2 == 0 else (i + 1, i, i + 2)


def assemble(mesh, provoking):
    """Vertex numbers of all triangles of a mesh. Source: OpenGL 1.2.1 sections 2.6.1, 2.8 (DrawElements)."""
    stream = list(range(len(mesh.positions))) if mesh.indices is None else mesh.indices.tolist()
    counts = [len(stream)] if mesh.counts is None else mesh.counts
    triangles, start = [], 0
    for count in counts:
        for corners in split_run(mesh.primitive, count, provoking):
            triangles.append([stream[start + corner] for corner in corners])
        start += count
    return triangles


# ---------------------------------------------------------------------------------------------- normals


def cofactor(m, i, j):
    """Cofactor of row i and column j of a 3x3 matrix. Source: OpenGL 1.2.1 section 2.10.3 (the inverse)."""
    i1, i2, j1, j2 = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
    return m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]


def inverse_3x3(matrix):
    """Inverse of the upper left 3x3 by cofactors; where there is none, the transpose. Source: OpenGL 1.2.1
    section 2.10.3 (undefined without an inverse); WineHQ dlls/d3d9/tests/visual.c, lighting_test (lit in
    full); Assumed: the transpose, by which the matrix itself turns normals.
    """
    m = [[float(x) for x in row[:3]] for row in matrix[:3]]
    c = [[cofactor(m, i, j) for j in range(3)] for i in range(3)]
    determinant = (m[0][0] * c[0][0] + m[0][1] * c[0][1]) + m[0][2] * c[0][2]
    if determinant == 0:
        return [[m[i][j] for i in range(3)] for j in range(3)]
    return [[c[i][j] / determinant for i in range(3)] for j in range(3)]


def normal_by(matrix, normal, rescaled):
    """A normal by a matrix's inverse. Source: OpenGL 1.2.1 section 2.10.3."""
    inverse = inverse_3x3(matrix)
    n = [weighted_sum([inverse[row][j] for row in range(3)], normal) for j in range(3)]
    factor = divide(1.0, length(inverse[2]))
    return [component * factor for component in n] if rescaled else n


def eye_normal(normal, vertex_state, weight):
    """The normal n_f in eye coordinates. Source: OpenGL 1.2.1 section 2.10.3; EXT_vertex_weighting; Assumed:
    each matrix's normal is rescaled by that matrix.
    """
    n = normal_by(vertex_state.modelview, normal, vertex_state.rescale_normal)
    if vertex_state.modelview1 is not None:
        m = normal_by(vertex_state.modelview1, normal, vertex_state.rescale_normal)
        n = [a * weight + b * (1.0 - weight) for a, b in zip(n, m, strict=True)]
    return normalize(n) if vertex_state.normalize else n


def eye_coordinates(position, vertex_state, weight):
    """Source: OpenGL 1.2.1 section 2.10.2; EXT_vertex_weighting; envytools: w is the first matrix's."""
    x, y, z, w = transform(vertex_state.modelview, position)
    if vertex_state.modelview1 is not None:
        x1, y1, z1, _ = transform(vertex_state.modelview1, position)
        x = x * weight + x1 * (1.0 - weight)
        y = y * weight + y1 * (1.0 - weight)
        z = z * weight + z1 * (1.0 - weight)
    return [x, y, z, w]


# --------------------------------------------------------------------------------------------- lighting


def material_colors(material, side, tracking, color):
    """Ambient, diffuse, specular, emission, and whether specular follows the vertex color.

    Source: OpenGL 1.2.1 section 2.13.3.
    """
    colors = {name: getattr(material, name) for name in ("ambient", "diffuse", "specular", "emission")}
    followers = []
    if tracking is not None and tracking.face in (side, Face.FRONT_AND_BACK):
        followers = lighting_unit.TRACKED[tracking.parameter]
    for name in followers:
        colors[name] = color
    return colors, "specular" in followers


def light_direction(light, v):
    """Unit vector from the vertex v to the light, and the distance. Source: OpenGL 1.2.1 section 2.13.1."""
    x, y, z, w = (float(component) for component in light.position)
    if w == 0:
        return normalize([x, y, z]), None
    difference = [x / w - v[0], y / w - v[1], z / w - v[2]]
    return normalize(difference), length(difference)


def attenuation(light, distance):
    """Equation 2.4. Source: OpenGL 1.2.1 section 2.13.1."""
    if distance is None:
        return 1.0
    factors = (light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation)
    return divide(1.0, weighted_sum(factors, (1.0, distance, distance * distance)))


def spotlight(light, direction):
    """Equation 2.5. Source: OpenGL 1.2.1 section 2.13.1; Assumed: a signed cosine against the cutoff."""
    if light.spot_cutoff == 180:
        return 1.0
    cosine = -dot(direction, normalize([float(component) for component in light.spot_direction]))
    if cosine >= cosine_of_degrees(light.spot_cutoff):
        return power(positive(cosine), light.spot_exponent)
    return 0.0


def light_vertex(lighting, side, eye, normal, color):
    """Primary RGBA and secondary RGBA of one face, not clamped. Source: OpenGL 1.2.1 section 2.13.1."""
    face_material = lighting.front if side == Face.FRONT else lighting.back
    material, follows = material_colors(face_material, side, lighting.color_material, color)
    v = [divide(component, eye[3]) for component in eye[:3]]
    to_eye = normalize([-component for component in v]) if lighting.local_viewer else [0.0, 0.0, 1.0]
    primary = [material["emission"][c] + material["ambient"][c] * lighting.model_ambient[c] for c in range(3)]
    secondary = [0.0, 0.0, 0.0]
    for light in lighting.lights:
        direction, distance = light_direction(light, v)
        strength = attenuation(light, distance) * spotlight(light, direction)
        n = normal if side == Face.FRONT else [-component for component in normal]
        diffuse = positive(dot(n, direction))
        specular = 0.0
        if diffuse > 0:
            half = normalize([direction[axis] + to_eye[axis] for axis in range(3)])
            specular = power(positive(dot(n, half)), face_material.shininess)
        shines = follows or any(material["specular"][c] * light.specular[c] != 0 for c in range(3))
        for c in range(3):
            term = material["ambient"][c] * light.ambient[c] + diffuse * (
                material["diffuse"][c] * light.diffuse[c]
            )
            if shines:
                shine = specular * (material["specular"][c] * light.specular[c])
                if lighting.separate_specular_color:
                    secondary[c] = secondary[c] + strength * shine
                else:
                    term = term + shine
            primary[c] = primary[c] + strength * term
    return [*primary, material["diffuse"][3], *secondary, 0.0]


def unit_colors(vertex_state, position, normal, given, weight):
    """Both faces' colors by a machine's lighting unit. Source: tests/reference/lighting_unit.py."""
    matrices = [m for m in (vertex_state.modelview, vertex_state.modelview1) if m is not None]
    inverses = [inverse_3x3(m) for m in matrices] if vertex_state.lighting.lights else None
    place = inverses, position, normal, weight
    sides = (Face.FRONT, Face.BACK) if vertex_state.lighting.two_side else (Face.FRONT, Face.FRONT)
    return [
        lighting_unit.light_vertex(vertex_state, side, *place, given[:4], given[4:], power) for side in sides
    ]


def vertex_colors(vertex_state, profile, position, eye, normal, object_normal, weight, given, given_back):
    """Front and back colors, clamped.

    Source: OpenGL 1.2.1 sections 2.13.1, 2.13.6; EXT_secondary_color; NV_vertex_program (two sides).
    """
    lighting, color = vertex_state.lighting, given[:4]
    if lighting is None:
        front, back = given, given_back if vertex_state.two_side else given
    elif profile.arithmetic.lighting == LightingArithmetic.LIGHTING_UNIT:
        front, back = unit_colors(vertex_state, position, object_normal, given, weight)
    else:
        front = light_vertex(lighting, Face.FRONT, eye, normal, color)
        back = light_vertex(lighting, Face.BACK, eye, normal, color) if lighting.two_side else front
    sides = [lighting_unit.secondary_output(side, vertex_state.secondary_color) for side in (front, back)]
    return tuple([clamp_color(c) for c in side] for side in sides)


def exactly_lit(state, profile):
    """Whether lighting is OpenGL's equations, which keep all bits. Source: OpenGL 1.2.1 section 2.13.9."""
    return state.vertex.lighting is not None and profile.arithmetic.lighting == LightingArithmetic.EQUATIONS


def color_codes(color, lit, profile, bits=8):
    """Eight components in [0, 1] as codes of so many bits.

    Measured: a colour of the vertex array or of a lighting unit keeps 14 significant bits (NV2A); Inferred:
    wider colours keep as many more.
    """
    if not lit:
        kept = profile.arithmetic.color_mantissa_bits + max(bits - 8, 0)
        color = [fixed.keep_significant_bits(c, kept) for c in color]
    return [math.floor((2**bits - 1) * c + 0.5) for c in color]


# ---------------------------------------------------------------------------------- texture coordinates


def reflection(eye, normal):
    """Reflection vector, u - 2 n (n . u). Source: OpenGL 1.2.1 section 2.10.4."""
    u = normalize(eye[:3])
    twice = dot(normal, u) * 2.0
    return [u[axis] - normal[axis] * twice for axis in range(3)]


def sphere_map(r):
    """S and t of a sphere map; Assumed: 1/2 where m = 0. Source: OpenGL 1.2.1 section 2.10.4."""
    m = length([r[0], r[1], r[2] + 1.0]) * 2.0
    return [(component / m if m != 0 else component) + 0.5 for component in r[:2]]


def transform_unit_reflection(eye, normal):
    """Measured: Texgen_with_texture_matrix ReflectionMap_RotateX, as OpenGL has it, in 24 bits."""
    u, _, _ = lighting_unit.unit_vector([lighting_unit.single(component) for component in eye[:3]])
    n = [lighting_unit.single(component) for component in normal]
    twice = lighting_unit.transform_dot(n, u) * 2
    shares = [lighting_unit.product(component, twice, lighting_unit.TRANSFORM) for component in n]
    return lighting_unit.difference(u, shares)


def transform_unit_sphere_map(r):
    """Measured: Texgen_with_texture_matrix SphereMap_Double, as OpenGL has it, in 24 bits."""
    h = [*r[:2], lighting_unit.total((r[2], Fraction(1)), lighting_unit.TRANSFORM)]
    root = lighting_unit.transform_inverse_root(lighting_unit.transform_dot(h, h)) / 2
    shares = [lighting_unit.product(component, root, lighting_unit.TRANSFORM) for component in r[:2]]
    return [lighting_unit.total((share, Fraction(1, 2)), lighting_unit.TRANSFORM) for share in shares]


def generate(gen, axis, given, position, eye, normal, in_unit):
    """One texture coordinate; ``in_unit``: by a transform unit.

    Source: OpenGL 1.2.1 section 2.10.4; NV_texgen_reflection.
    """
    if gen.mode == TexGenMode.OBJECT_LINEAR:
        return weighted_sum(gen.plane, position)
    if gen.mode == TexGenMode.EYE_LINEAR:
        return weighted_sum(gen.plane, eye)
    if gen.mode == TexGenMode.NORMAL_MAP:
        return normal[axis]
    if gen.mode in (TexGenMode.REFLECTION_MAP, TexGenMode.SPHERE_MAP) and in_unit:
        r = transform_unit_reflection(eye, normal)
        made = r if gen.mode == TexGenMode.REFLECTION_MAP else transform_unit_sphere_map(r)
        return float(made[axis])
    if gen.mode == TexGenMode.REFLECTION_MAP:
        return reflection(eye, normal)[axis]
    if gen.mode == TexGenMode.SPHERE_MAP:
        return sphere_map(reflection(eye, normal))[axis]
    return given


def unit_coordinates(unit, sets, position, eye, normal, in_unit):
    """s, t, r, q of one unit. Source: OpenGL 1.2.1 sections 2.10.2 (texture matrix), 2.10.4."""
    if unit is None:
        return [0.0, 0.0, 0.0, 1.0]
    given = sets[unit.coordinates] if unit.coordinates < len(sets) else []
    given = padded(given, (0.0, 0.0, 0.0, 1.0))
    generated = [
        generate(unit.gen[axis], axis, given[axis], position, eye, normal, in_unit) for axis in range(4)
    ]
    return transform(unit.matrix, generated)


# --------------------------------------------------------------------------------------------- clipping


def clip_distances(vertex_state, profile, width, height, depth_clamp):
    """Distance functions of a vertex, in clipping order.

    Source: OpenGL 1.2.1 section 2.11; Measured: the sides of the view volume do not clip, nor do near and far
    with a composite matrix (NV2A, Fog captures). With NV_depth_clamp the eye's plane takes their place.
    """
    guard = profile.arithmetic.guard_band
    near_and_far = [lambda v: v.clip[2] + v.clip[3], lambda v: v.clip[3] - v.clip[2]]
    if vertex_state.composite is None:
        (half_x, half_y), (center_x, center_y) = viewport_frame(vertex_state.viewport, width, height)
    else:
        half_x = half_y = 1.0
        center_x, center_y = (fixed.to_single(offset) for offset in vertex_state.composite.offset[:2])
        depth_clamp = True
    return [
        *([lambda v: v.clip[3] - NEAREST_W] if depth_clamp else near_and_far),
        *((lambda v, plane=plane: weighted_sum(plane, v.eye)) for plane in vertex_state.clip_planes),
        lambda v: v.clip[0] * half_x + (center_x + guard) * v.clip[3],
        lambda v: ((width + guard) - center_x) * v.clip[3] - v.clip[0] * half_x,
        lambda v: v.clip[1] * half_y + (center_y + guard) * v.clip[3],
        lambda v: ((height + guard) - center_y) * v.clip[3] - v.clip[1] * half_y,
    ]


def between(inside, outside, t):
    """The vertex at t on the edge from inside to outside. Source: OpenGL 1.2.1 sections 2.11, 2.13.8."""
    if isinstance(inside, list | tuple):
        values = [between(a, b, t) for a, b in zip(inside, outside, strict=True)]
        return Vertex(*values) if isinstance(inside, Vertex) else values
    return inside + t * (outside - inside)


def clip_polygon(polygon, distance):
    """Sutherland and Hodgman's rule for one plane. Source: OpenGL 1.2.1 section 2.11."""
    result = []
    for here, there in zip(polygon, polygon[1:] + polygon[:1], strict=True):
        d_here, d_there = distance(here), distance(there)
        if d_here >= 0:
            result.append(here)
            if not d_there >= 0:
                result.append(between(here, there, divide(d_here, d_here - d_there)))
        elif d_there >= 0:
            result.append(between(there, here, divide(d_there, d_there - d_here)))
    return result


def clip_triangle(triangle, distances):
    """The polygon that is left of a triangle. Source: OpenGL 1.2.1 section 2.11."""
    outside = [[not distance(v) >= 0 for v in triangle] for distance in distances]
    if any(all(plane) for plane in outside):
        return []
    polygon = triangle
    for distance, plane in zip(distances, outside, strict=True):
        if any(plane):
            polygon = clip_polygon(polygon, distance)
    return polygon


# ------------------------------------------------------------------------------------------------ window


def viewport_frame(viewport, width, height):
    """Half the viewport's size and its middle. Source: OpenGL 1.2.1 section 2.10.1."""
    half_x = (width if viewport.width is None else viewport.width) * 0.5
    half_y = (height if viewport.height is None else viewport.height) * 0.5
    return (half_x, half_y), (viewport.x + half_x, viewport.y + half_y)


def snap(device, extent, profile):
    """A device coordinate in 1/16 pixel.

    Measured: truncation toward zero (NV2A, TopLeftRaster); Inferred: the guard band's clamp.
    """
    device = device if device > -profile.arithmetic.guard_band else float(-profile.arithmetic.guard_band)
    return math.trunc(
        min(device, float(extent + profile.arithmetic.guard_band))
        * float(2**profile.arithmetic.subpixel_bits)
    )


def composite_to_window(v, composite, height):
    """Window x, y (up), depth units and 1/w.

    Measured: single precision toward zero (NV2A, Viewport captures, 2138672 of 2138672 pixels); the transform
    unit's reciprocal (Depth_buffer_fixed_function z24_Cn_FZn_Mffffff: 48089 depths); w itself for weights
    (FloorQuad_V0, 33 texels).
    """
    *coordinates, w = v.clip
    reciprocal = float(lighting_unit.transform_reciprocal(Fraction(w) if math.isfinite(w) else w))
    x, y, z = (
        fixed.keep_significant_bits(fixed.keep_significant_bits(c * reciprocal, 24) + fixed.to_single(o), 24)
        for c, o in zip(coordinates, composite.offset, strict=True)
    )
    own = 1.0 / w if math.isfinite(reciprocal) and reciprocal else reciprocal
    return x, height - y, z, own


def viewport_to_window(v, viewport, width, height):
    """Window x, y and z, and 1/w. Source: OpenGL 1.2.1 section 2.10.1."""
    half, center = viewport_frame(viewport, width, height)
    x, y, z, w = v.clip
    window_x = divide(x, w) * half[0] + center[0]
    window_y = divide(y, w) * half[1] + center[1]
    near, far = float(viewport.near), float(viewport.far)
    window_z = divide(z, w) * ((far - near) * 0.5) + (far + near) * 0.5
    inverse_w = divide(1.0, w)
    return window_x, window_y, window_z, inverse_w


def to_window(v, state, profile, width, height):
    """A WindowVertex, or None if it has no finite window position. Source: OpenGL 1.2.1 section 2.10.1."""
    if state.vertex.composite is not None:
        window_x, window_y, window_z, inverse_w = composite_to_window(v, state.vertex.composite, height)
    else:
        window_x, window_y, window_z, inverse_w = viewport_to_window(v, state.vertex.viewport, width, height)
    if not inverse_w > 0 or not all(map(math.isfinite, (window_x, window_y, window_z, inverse_w))):
        return None
    if profile.arithmetic.device_origin == WindowOrigin.UPPER_LEFT:
        snapped_y = snap(height - window_y, height, profile)
    else:
        snapped_y = height * 2**profile.arithmetic.subpixel_bits - snap(window_y, height, profile)
    return WindowVertex(
        snap(window_x, width, profile),
        snapped_y,
        window_z if state.vertex.depth_units or state.depth_clamp else clamp_color(window_z),
        inverse_w,
        [color_codes(side, exactly_lit(state, profile), profile) for side in v.colors],
        v.coordinates,
        v.fog,
    )


# ------------------------------------------------------------------------------------------------- whole


def padded(values, defaults):
    """Missing components take their defaults. Source: OpenGL 1.2.1 section 2.7."""
    return [*values, *defaults[len(values) :]]


def given_color(array, i, default):
    """Vertex i's color of an array that may be absent. Source: OpenGL 1.2.1 section 2.7."""
    return padded([] if array is None else array[i].tolist(), default)


def fog_of_vertex(mesh, i, state, eye, profile):
    """What is iterated for fog: the coordinate, or NV2A's line. Source: OpenGL 1.2.1 section 3.10."""
    if state.fog is None:
        return 0.0
    coordinate = fog_coordinate(mesh, i, state, eye)
    if profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
        return fog.vertex_value(state.fog, coordinate)
    return coordinate


def fog_coordinate(mesh, i, state, eye):
    """Source: EXT_fog_coord; Measured: the NV2A's generations (Fog_gen), a program's none."""
    own = 0.0 if mesh.fog_coordinates is None else float(mesh.fog_coordinates[i])
    registers = state.fog.registers
    if registers is None:
        return own if state.fog.coordinate_source == FogCoordinateSource.FOG_COORDINATE else abs(eye[2])
    programmed = state.vertex.stage == VertexStage.PROGRAM_RESULTS
    kind = FogGeneration.FOG_COORDINATE if programmed else registers.generation
    if kind == FogGeneration.FOG_COORDINATE:
        coordinate = own
    elif kind == FogGeneration.SECONDARY_ALPHA:
        given = [] if mesh.secondary_colors is None else mesh.secondary_colors[i].tolist()
        coordinate = padded(given, (0.0, 0.0, 0.0, 0.0))[3]
    elif kind == FogGeneration.RADIAL:
        coordinate = radius([lighting_unit.single(c) for c in eye[:3]])
    else:
        coordinate = weighted_sum(registers.plane, eye)
    absolute = registers.absolute and not fog.folds(state.fog)
    return abs(coordinate) if absolute or kind == FogGeneration.ABSOLUTE_PLANAR else coordinate


def radius(v):
    """Measured: the transform unit's length, FogGen_FF-linear-radial, 305553 of 305556 pixels."""
    squared = lighting_unit.transform_dot(v, v)
    root = lighting_unit.transform_inverse_root(squared)
    return lighting_unit.product(squared, root, lighting_unit.TRANSFORM)


def clip_coordinates(vertex_state, position, eye, weight):
    """x, y, z and w before the division. Source: OpenGL 1.2.1 section 2.10; Measured: NV2A's composite, which
    is of eye coordinates where they are weighted (envytools, pgraph_celsius_xf_full).
    """
    if vertex_state.composite is not None:
        if vertex_state.modelview1 is not None:
            position = lighting_unit.eye_coordinates(vertex_state, position, weight)
        return composite_product(vertex_state.composite.matrix, position)
    return transform(vertex_state.projection, eye)


def process_vertex(mesh, i, state, profile):
    """Vertex i up to clip coordinates. Source: OpenGL 1.2.1 figure 2.6 (section 2.10)."""
    vertex_state = state.vertex
    position = padded(mesh.positions[i].tolist(), (0.0, 0.0, 0.0, 1.0))
    weight = 1.0 if mesh.weights is None else float(mesh.weights[i])
    eye = eye_coordinates(position, vertex_state, weight)
    given_normal = (0.0, 0.0, 1.0) if mesh.normals is None else mesh.normals[i].tolist()
    from_normal = (TexGenMode.SPHERE_MAP, TexGenMode.NORMAL_MAP, TexGenMode.REFLECTION_MAP)
    lit = vertex_state.lighting is not None and vertex_state.lighting.lights
    needed = lit or any(gen.mode in from_normal for unit in state.texture_units if unit for gen in unit.gen)
    normal = eye_normal(given_normal, vertex_state, weight) if needed else None
    white, black, clear = (1.0, 1.0, 1.0, 1.0), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0, 0.0)
    given = given_color(mesh.colors, i, white) + given_color(mesh.secondary_colors, i, clear)
    back = given_color(mesh.back_colors, i, black) + given_color(mesh.back_secondary_colors, i, black)
    sets = [texture_set[i].tolist() for texture_set in mesh.texture_coordinates]
    in_unit = profile.arithmetic.lighting == LightingArithmetic.LIGHTING_UNIT
    return Vertex(
        clip_coordinates(vertex_state, position, eye, weight),
        eye,
        vertex_colors(vertex_state, profile, position, eye, normal, given_normal, weight, given, back),
        [unit_coordinates(unit, sets, position, eye, normal, in_unit) for unit in state.texture_units],
        fog_of_vertex(mesh, i, state, eye, profile),
    )


def process(mesh, state, profile, width, height):
    """All triangles of a mesh in window coordinates. Source: OpenGL 1.2.1 chapter 2."""
    result = Assembled()
    lit = exactly_lit(state, profile)
    distances = clip_distances(state.vertex, profile, width, height, state.depth_clamp is not None)
    vertices = [process_vertex(mesh, i, state, profile) for i in range(len(mesh.positions))]
    for *corners, provoking in assemble(mesh, state.polygon.provoking_vertex):
        triangle = [vertices[corner] for corner in corners]
        if not all(math.isfinite(c) for v in triangle for c in v.clip):
            result.dropped += 1
            continue
        polygon = clip_triangle(triangle, distances)
        if len(polygon) < 3:
            continue
        window = [to_window(v, state, profile, width, height) for v in polygon]
        if None in window:
            result.dropped += 1
            continue
        flat = [color_codes(side, lit, profile) for side in vertices[provoking].colors]
        for i in range(1, len(window) - 1):
            result.triangles.append(((window[0], window[i], window[i + 1]), flat))
    return result
