"""Common parts of the lighting suites.

They are models, the default view with eye coordinates, lights as the programs set them, and combiners that
add both vertex colours.

Source: nxdk_pgraph_tests and pbkitplusplus: src/light.cpp, src/models/ (the .mesh files' layout),
NV2AState::SetXDKDefaultViewportAndFixedFunctionMatrices. Eye coordinates have the viewer at the origin, z
growing into the screen.
"""

from dataclasses import dataclass, replace

import numpy as np

from fixedpipe.effects.conformance import scenes, vertex_programs
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.scenes import single
from fixedpipe.effects.passes.combiners import PRIMARY, SECONDARY, SPARE0, program, shown, stage, total
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.state import Light, Spot
from fixedpipe.pipeline.vertices.lighting_unit import light_vertices

MODELS = ("cone", "cylinder", "sphere", "suzanne", "torus")
GRID = "flat_mesh_grid"
BLACK, WHITE = (0.0, 0.0, 0.0, 1.0), (1.0, 1.0, 1.0, 1.0)
MECH_ASSAULT = (-0.838916, -2.887156, 3.048239, -0.706496, -2.507095, 2.800600)
COEFFICIENTS = {  # of the SpecParams cases, by the names that they have there
    "MechAssault": MECH_ASSAULT,
    "NinjaGaidenBlack": (-0.932112, -3.097628, 3.165516, -0.869210, -2.935466, 3.066255),
    "AllZero": (0.0,) * 6,
    "InvMechAssault": tuple(-c for c in MECH_ASSAULT),
    "Pow0_1": (-0.0, 0.9, 0.1, -0.0, 0.95, 0.05),
    "Pow1_0": (-0.0, -0.494592, 1.49459, -0.000244, 0.500122, 0.499634),
    "Pow2_0": (-0.170208, -0.855843, 1.68563, -0.0, -0.494592, 1.49459),
    "Pow4_0": (-0.421539, -1.70592, 2.28438, -0.170208, -0.855842, 1.68563),
    "Pow8_0": (-0.64766, -2.36199, 2.71433, -0.421539, -1.70592, 2.28438),
    "Pow16_0": (-0.803673, -2.7813, 2.97762, -0.64766, -2.36199, 2.71433),
    "Pow24_0": (-0.863702, -2.92701, 3.06331, -0.747554, -2.6184, 2.87085),
}
EYE_DISTANCE = scenes.XDK_EYE
TOWARDS_VIEWER = (0.0, 0.0, -1.0)
EYE_DIRECTION = (0.0, 0.0, 0.0)


def view(depth_maximum=16777215.0, near=1.0, far=200.0):
    """The default view as vertex state whose modelview matrix ends in eye coordinates."""
    return scenes.xdk_vertex(near=near, far=far, depth_maximum=depth_maximum)


def sum_of_colors():
    """Combiners whose result is primary plus secondary colour, alpha too."""
    both_halves = total(PRIMARY, SECONDARY, to=SPARE0)
    return program(stage(both_halves, alpha=both_halves), shown(SPARE0, alpha=SPARE0))


def state(lighting, combiners=None, *, polygon=scenes.FRONT_FACES, **vertex):
    """The state of a lit Draw in the default view.

    ``combiners``: None: ``sum_of_colors``. ``vertex``: more of VertexState.
    """
    return replace(
        scenes.DEFAULT,
        vertex=replace(view(), lighting=lighting, **vertex),
        register_combiners=combiners or sum_of_colors(),
        polygon=polygon,
    )


@dataclass(frozen=True)
class Model:
    """Vertices of a .mesh file: positions and normals, float64 [n, 3], three for each triangle."""

    positions: np.ndarray
    normals: np.ndarray

    def mesh(self, color=None, secondary=None, **arrays):
        """The triangles with one colour for all vertices."""
        count = len(self.positions)
        given = {"colors": color, "secondary_colors": secondary, **arrays}
        arrays = {name: np.tile(single(v), (count, 1)) for name, v in given.items() if v is not None}
        return Mesh(self.positions, normals=self.normals, **arrays)


def model(inputs, name):
    """Read a model's .mesh: a vertex count, then two arrays, each led by its number of floats."""
    file = f"light_control_test_mesh_{name}.mesh" if name in MODELS else f"{name}.mesh"
    data = inputs.path(file).read_bytes()
    size = int(np.frombuffer(data, "<u4", 1, 4)[0])
    positions = np.frombuffer(data, "<f4", size, 8).reshape(-1, 3)
    normals = np.frombuffer(data, "<f4", size, 12 + 4 * size).reshape(-1, 3)
    return Model(positions.astype(np.float64), normals.astype(np.float64))


def model_draws(inputs, names, color, secondary, state):
    """A Draw for each model, with one primary and one secondary colour."""
    return [Draw(label=name, mesh=model(inputs, name).mesh(color, secondary), state=state) for name in names]


def unit(vector):
    """The vector times its length's reciprocal, every step in single precision, as the programs do it."""
    x, y, z = v = np.asarray(vector, np.float32)
    length = np.sqrt(x * x + y * y + z * z)
    return tuple((v * (np.float32(1.0) / length)).tolist())


def color(rgb):
    """A colour register's red, green and blue, as RGBA."""
    return (*single(rgb).tolist(), 1.0)


def colors(ambient=(0.0, 0.0, 0.0), diffuse=(1.0, 1.0, 1.0), specular=(0.0, 0.0, 0.0)):
    """A light's three colours, as keyword arguments."""
    return {"ambient": color(ambient), "diffuse": color(diffuse), "specular": color(specular)}


def directional(direction, **given):
    """DirectionalLight: shines along ``direction``, without normalizing it. The half vector is the unit
    vector of direction plus the viewer's.
    """
    d = single(direction)
    half = unit(d - TOWARDS_VIEWER)
    position = (*(-d).tolist(), 0.0)
    return Light(position=position, half_vector=tuple(-c for c in half), **given)


def point(position, light_range, attenuation, **given):
    """PointLight at a world position."""
    x, y, z = position
    constant, linear, quadratic = single(attenuation).tolist()
    return Light(
        position=(x, y, z + EYE_DISTANCE, 1.0),
        range=light_range,
        constant_attenuation=constant,
        linear_attenuation=linear,
        quadratic_attenuation=quadratic,
        **given,
    )


def spotlight(position, direction, light_range, cone, attenuation, falloff, **given):
    """Spotlight at a world position; ``cone``: degrees of the outer and the inner cone, ``falloff``: its
    coefficients.

    Source: Spotlight::Commit: the axis is scaled so that the factor runs from 0 to 1 between the cones. If
    these are equal, it divides by 0, and the axis has NaN and infinities. The chip's factor is then that of
    the axis (0, 0, 0, 1) (N2.16).
    """
    outer, inner = (single(np.cos(single(0.5 * single(angle * single(np.pi / 180))))) for angle in cone)
    axis = (0.0, 0.0, 0.0, 1.0)
    if outer != inner:
        scale = single(-1.0 / single(inner - outer))
        axis = (*single(scale * np.array(unit(direction))).tolist(), float(single(outer * scale)))
    light = point(position, light_range, attenuation, **given)
    return replace(light, spot=Spot(axis, tuple(single(falloff).tolist())))


def unproject(x, y, z):
    """World position [3] of a device pixel at world depth ``z`` in the default view."""
    w = z + EYE_DISTANCE
    world = ((x - WIDTH / 2) * w / scenes.XDK_SCALE, (HEIGHT / 2 - y) * w / scenes.XDK_SCALE, z)
    return single(world)


def lit_colors(vertex, points, normals, sides):
    """The colours by which the chip's lighting unit replaces those of a vertex program: (primary, secondary),
    each [n, 4], for every side in ``sides``, whose colours are the vertices' own.

    Measured: ControlFlagsNoLight and ControlFlags_VS captures. Each side keeps the alpha of its own secondary
    colour; where specular colour is not separate, all of it.
    """
    own = [[single(array) for array in side] for side in sides]
    colors, secondary_colors = own[0]
    mesh = Mesh(single(points), colors=colors, secondary_colors=secondary_colors, normals=single(normals))
    lit = light_vertices(vertex, mesh, clamped=False)
    result = []
    for side, (_, secondary) in zip((lit[:8], lit[-8:]), own, strict=False):
        separate = vertex.lighting.separate_specular_color
        rgb = side[4:7].T if separate else secondary[:, :3]
        given = np.column_stack([rgb, secondary[:, 3]])
        result.append((side[:4].T, given))
    return result


def program_background():
    """Corners of the background under a vertex program in the default view: without the viewport's offset."""
    places = scenes.rectangle(0, 0, WIDTH, HEIGHT)
    return vertex_programs.perspective(np.array([unproject(x, y, 1.0) for x, y, _ in places]))
