"""Small OpenGL programs of this project's own, in the manner of 1999, as traces that may be shared.

    python docs/examples/traces/programs.py DIR

writes corridor.trace, bumps.trace and shapes.trace, each of two frames, and corridor.png: the second frame
of the corridor on plain OpenGL 1.2 and on the GeForce 256 (above), the ideal and the GeForce 256's difference
from it, 16 times as large (below). It needs no display and no driver.
"""

import sys
from pathlib import Path

import numpy as np

from fixedpipe.effects.replays.beside import difference_picture
from fixedpipe.effects.replays.driving import drawn_frames, frame_of_trace
from fixedpipe.effects.replays.recorder import Recorder
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.opengl import tokens as T
from fixedpipe.pipeline.profiles import GEFORCE_256, OPENGL_1_2

RANDOM = 1999  # the seed of what looks rough


def _texture(gl, name, texels, *, clamp=False):
    """A texture of uint8 [h, w, 3 or 1], with mipmaps; the first row is its lowest."""
    layout = T.RGB if texels.shape[-1] == 3 else T.LUMINANCE
    gl.BindTexture(T.TEXTURE_2D, name)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MIN_FILTER, T.LINEAR if clamp else T.LINEAR_MIPMAP_LINEAR)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_MAG_FILTER, T.LINEAR)
    if clamp:
        gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_WRAP_S, T.CLAMP)
        gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_WRAP_T, T.CLAMP)
    level = 0
    while True:
        height, width = texels.shape[:2]
        gl.TexImage2D(T.TEXTURE_2D, level, layout, width, height, 0, layout, T.UNSIGNED_BYTE, texels)
        if clamp or width == 1:
            return
        quarters = texels.reshape(height // 2, 2, width // 2, 2, -1).astype(np.uint16)
        texels, level = ((quarters.sum(axis=(1, 3)) + 2) // 4).astype(np.uint8), level + 1


def _bricks():
    """A wall of bricks: uint8 [32, 32, 3]."""
    rough = np.random.default_rng(RANDOM).integers(-24, 24, (32, 32, 1))
    y, x = np.mgrid[:32, :32]
    mortar = (y % 8 == 0) | ((x + 8 * (y // 8 % 2)) % 16 == 0)
    colors = np.where(mortar[..., None], (150, 145, 135), (140, 62, 40))
    return np.clip(colors + rough, 0, 255).astype(np.uint8)


def _lamp_light():
    """A lightmap: the lamp's light on a wall, uint8 [16, 16, 1]."""
    y, x = (np.mgrid[:16, :16] - 7.5) / 8
    light = 40 + 215 * np.exp(-2.5 * (x * x + y * y))
    return np.clip(light, 0, 255).astype(np.uint8)[..., None]


def _torus(around=24, across=12):
    """(vertices with normals, float32 [n, 6]; indices of quads, uint16 [m])."""
    u, v = np.meshgrid(np.arange(around) / around, np.arange(across) / across, indexing="ij")
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    normals = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    centers = np.stack([np.cos(u), np.sin(u), 0 * u], axis=-1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    corner = lambda di, dj: (i + di) % around * across + (j + dj) % across  # noqa: E731
    quads = np.stack([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)], axis=-1)
    vertices = np.concatenate([normals, centers + 0.4 * normals], axis=-1)
    return vertices.astype("<f4"), quads.astype("<u2").ravel()


# The corridor's walls: each a corner, and two edges from it.
_WALLS = (
    ((-2, -1.5, 0), (4, 0, 0), (0, 0, -12)),  # the floor
    ((-2, 1.5, -12), (4, 0, 0), (0, 0, 12)),
    ((-2, -1.5, 0), (0, 0, -12), (0, 3, 0)),
    ((2, -1.5, -12), (0, 0, 12), (0, 3, 0)),
    ((-2, -1.5, -12), (4, 0, 0), (0, 3, 0)),
)


def _walls(gl):
    """All walls in pieces of about 4 units, with coordinates."""
    gl.Begin(T.QUADS)
    for corner, right, up in _WALLS:
        corner, right, up = (np.array(each, float) for each in (corner, right, up))
        pieces = [max(1, round(np.abs(edge).sum() / 4)) for edge in (right, up)]
        for i in range(pieces[0]):
            for j in range(pieces[1]):
                for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    s, t = (i + a) / pieces[0], (j + b) / pieces[1]
                    gl.TexCoord2f(np.abs(right).sum() * s / 2, np.abs(up).sum() * t / 2)
                    gl.Vertex3f(*(corner + s * right + t * up).tolist())
    gl.End()


def corridor(gl):
    """A game's corridor: bricks, their light in a second pass, fog, a lit ring, a lamp's glow.

    The second pass draws the same list again, with coordinates that the texture matrix scales. So a machine
    with one texture unit draws it.
    """
    gl.MatrixMode(T.PROJECTION)
    gl.Frustum(-0.8, 0.8, -0.6, 0.6, 1.0, 30.0)
    gl.MatrixMode(T.MODELVIEW)
    gl.PixelStorei(T.UNPACK_ALIGNMENT, 1)
    _texture(gl, 1, _bricks())
    _texture(gl, 2, _lamp_light(), clamp=True)
    vertices, quads = _torus()
    gl.Enable(T.DEPTH_TEST)
    gl.Enable(T.CULL_FACE)
    gl.Fogi(T.FOG_MODE, T.EXP)
    gl.Fogf(T.FOG_DENSITY, 0.09)
    gl.Fogfv(T.FOG_COLOR, (0.05, 0.06, 0.12, 1.0))
    gl.Lightfv(T.LIGHT0, T.POSITION, (0.0, 1.2, -3.0, 1.0))
    gl.Lightfv(T.LIGHT0, T.DIFFUSE, (1.0, 0.9, 0.7, 1.0))
    gl.Materialfv(T.FRONT, T.AMBIENT_AND_DIFFUSE, (0.75, 0.55, 0.2, 1.0))
    gl.Materialfv(T.FRONT, T.SPECULAR, (0.9, 0.9, 0.7, 1.0))
    gl.Materialf(T.FRONT, T.SHININESS, 24.0)
    gl.NewList(1, T.COMPILE)
    _walls(gl)
    gl.EndList()
    for frame in range(2):
        gl.Clear(T.COLOR_BUFFER_BIT | T.DEPTH_BUFFER_BIT)
        gl.LoadIdentity()
        gl.Translatef(-0.3 + 0.2 * frame, 0.0, 0.4)
        gl.Rotatef(6.0, 0.0, 1.0, 0.0)
        gl.Color3f(1.0, 1.0, 1.0)
        gl.Enable(T.TEXTURE_2D)
        gl.Enable(T.FOG)
        gl.BindTexture(T.TEXTURE_2D, 1)
        gl.CallList(1)
        _lamplight_pass(gl)
        gl.Disable(T.TEXTURE_2D)
        _ring(gl, vertices, quads, 35.0 * frame)
        _glow(gl)
        gl.swap()


def _lamplight_pass(gl):
    """Multiply the walls by their light: the same walls, once more."""
    gl.DepthMask(False)
    gl.DepthFunc(T.EQUAL)
    gl.Disable(T.FOG)
    gl.Enable(T.BLEND)
    gl.BlendFunc(T.ZERO, T.SRC_COLOR)
    gl.BindTexture(T.TEXTURE_2D, 2)
    gl.MatrixMode(T.TEXTURE)
    gl.Scalef(0.5, 0.5, 1.0)
    gl.MatrixMode(T.MODELVIEW)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_WRAP_S, T.REPEAT)
    gl.TexParameteri(T.TEXTURE_2D, T.TEXTURE_WRAP_T, T.REPEAT)
    gl.CallList(1)
    gl.MatrixMode(T.TEXTURE)
    gl.LoadIdentity()
    gl.MatrixMode(T.MODELVIEW)
    gl.Disable(T.BLEND)
    gl.DepthFunc(T.LESS)
    gl.DepthMask(True)


def _ring(gl, vertices, quads, angle):
    """A lit ring from arrays."""
    gl.Enable(T.LIGHTING)
    gl.Enable(T.LIGHT0)
    gl.Enable(T.NORMALIZE)
    gl.PushMatrix()
    gl.Translatef(0.2, -0.25, -4.2)
    gl.Rotatef(60.0 + angle, 1.0, 0.4, 0.0)
    gl.Scalef(0.75, 0.75, 0.75)
    gl.EnableClientState(T.NORMAL_ARRAY)
    gl.EnableClientState(T.VERTEX_ARRAY)
    gl.NormalPointer(T.FLOAT, 12, np.ascontiguousarray(vertices[:, :3]))
    gl.VertexPointer(3, T.FLOAT, 12, np.ascontiguousarray(vertices[:, 3:]))
    gl.DrawElements(T.QUADS, quads.size, T.UNSIGNED_SHORT, quads)
    gl.DisableClientState(T.VERTEX_ARRAY)
    gl.DisableClientState(T.NORMAL_ARRAY)
    gl.PopMatrix()
    gl.Disable(T.LIGHTING)


def _glow(gl):
    """The lamp's glow, added."""
    gl.Enable(T.BLEND)
    gl.BlendFunc(T.SRC_ALPHA, T.ONE)
    gl.DepthMask(False)
    gl.Begin(T.TRIANGLE_FAN)
    gl.Color4f(1.0, 0.9, 0.6, 0.9)
    gl.Vertex3f(0.0, 1.2, -3.5)
    gl.Color4f(1.0, 0.6, 0.2, 0.0)
    for k in range(17):
        angle = np.pi * k / 8
        gl.Vertex3f(0.7 * np.cos(angle), 1.2 + 0.7 * np.sin(angle), -3.5)
    gl.End()
    gl.DepthMask(True)
    gl.Disable(T.BLEND)


def bumps(gl):
    """A bumpy wall by register combiners: N · L of a normal map, for the GeForce 256."""
    y, x = np.mgrid[:64, :64] * (2 * np.pi / 16)
    slopes = np.stack([0.8 * np.cos(x) * np.sin(y), 0.8 * np.sin(x) * np.cos(y), np.ones((64, 64))], axis=-1)
    normals = slopes / np.linalg.norm(slopes, axis=-1, keepdims=True)
    gl.PixelStorei(T.UNPACK_ALIGNMENT, 1)
    _texture(gl, 1, np.rint(127.5 + 127.5 * normals).astype(np.uint8))
    gl.Enable(T.TEXTURE_2D)
    gl.Enable(T.REGISTER_COMBINERS_NV)
    gl.CombinerParameteriNV(T.NUM_GENERAL_COMBINERS_NV, 1)
    half = T.EXPAND_NORMAL_NV
    gl.CombinerInputNV(T.COMBINER0_NV, T.RGB, T.VARIABLE_A_NV, T.TEXTURE0, half, T.RGB)
    gl.CombinerInputNV(T.COMBINER0_NV, T.RGB, T.VARIABLE_B_NV, T.PRIMARY_COLOR_NV, half, T.RGB)
    to = (T.SPARE0_NV, T.DISCARD_NV, T.DISCARD_NV, T.NONE, T.NONE, True, False, False)
    gl.CombinerOutputNV(T.COMBINER0_NV, T.RGB, *to)
    for variable, register, mapping in (
        (T.VARIABLE_A_NV, T.SPARE0_NV, T.UNSIGNED_IDENTITY_NV),
        (T.VARIABLE_B_NV, T.CONSTANT_COLOR0_NV, T.UNSIGNED_IDENTITY_NV),
        (T.VARIABLE_C_NV, T.ZERO, T.UNSIGNED_IDENTITY_NV),
        (T.VARIABLE_D_NV, T.ZERO, T.UNSIGNED_IDENTITY_NV),
    ):
        gl.FinalCombinerInputNV(variable, register, mapping, T.RGB)
    gl.CombinerParameterfvNV(T.CONSTANT_COLOR0_NV, (0.9, 0.8, 0.6, 1.0))
    for frame in range(2):
        gl.Clear(T.COLOR_BUFFER_BIT)
        light = np.array([0.6 - 1.2 * frame, 0.5, 0.7])
        color = (0.5 + 0.5 * light / np.linalg.norm(light)).tolist()
        gl.Begin(T.QUADS)
        gl.Color3f(*color)
        for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
            gl.TexCoord2f(2.0 * s, 2.0 * t)
            gl.Vertex2f(1.8 * s - 0.9, 1.8 * t - 0.9)
        gl.End()
        gl.swap()


def shapes(gl):
    """OpenGL 1.1's smaller things: points, stippled lines and polygons, bitmaps, pixels, an evaluator."""
    gl.MatrixMode(T.PROJECTION)
    gl.Ortho(0.0, 128.0, 0.0, 96.0, -1.0, 1.0)
    gl.MatrixMode(T.MODELVIEW)
    gl.PixelStorei(T.UNPACK_ALIGNMENT, 1)
    for frame in range(2):
        gl.ClearColor(0.1, 0.1, 0.2, 1.0)
        gl.Clear(T.COLOR_BUFFER_BIT)
        gl.PushAttrib(T.ALL_ATTRIB_BITS)
        gl.PointSize(5.0)
        gl.Begin(T.POINTS)
        for k in range(6):
            gl.Color3f(1.0, k / 5, 0.2)
            gl.Vertex2f(10.5 + 8 * k, 85.5)
        gl.End()
        gl.Enable(T.LINE_STIPPLE)
        gl.LineStipple(1 + frame, 0x0F0F)
        gl.Begin(T.LINE_LOOP)
        gl.Color3f(0.3, 0.9, 0.4)
        for x, y in ((70, 60), (120, 60), (120, 90), (70, 90)):
            gl.Vertex2i(x, y)
        gl.End()
        gl.Enable(T.POLYGON_STIPPLE)
        gl.PolygonStipple(np.tile(np.array([0xCC, 0x33], np.uint8).repeat(4), 16).tolist())
        gl.Color3f(0.9, 0.7, 0.2)
        gl.Rectf(74.0, 64.0, 116.0, 86.0)
        gl.PopAttrib()
        gl.Color3f(0.9, 0.3, 0.6)
        points = (8.0, 10.0, 0.0, 30.0, 75.0, 0.0, 50.0, -30.0 + 20 * frame, 0.0, 62.0, 50.0, 0.0)
        gl.Map1f(T.MAP1_VERTEX_3, 0.0, 1.0, 3, 4, points)
        gl.Enable(T.MAP1_VERTEX_3)
        gl.MapGrid1f(24, 0.0, 1.0)
        gl.EvalMesh1(T.LINE, 0, 24)
        gl.RasterPos2i(74, 40)
        gl.Color3f(1.0, 1.0, 1.0)
        rows = [0x18, 0x3C, 0x7E, 0xFF, 0x18, 0x18, 0x18, 0x18]
        for _ in range(4):
            gl.Bitmap(8, 8, 0.0, 0.0, 10.0, 0.0, bytes(rows))
        gl.RasterPos2i(74, 8)
        y, x = np.mgrid[:8, :12]
        pixels = np.stack([x * 20, y * 30, np.full_like(x, 128)], axis=-1).astype(np.uint8)
        gl.PixelZoom(3.0, 3.0)
        gl.DrawPixels(12, 8, T.RGB, T.UNSIGNED_BYTE, pixels)
        gl.PixelZoom(1.0, 1.0)
        gl.swap()


# Each program, and its window's pixels.
PROGRAMS = {"corridor": (corridor, 320, 240), "bumps": (bumps, 128, 128), "shapes": (shapes, 128, 96)}


def write(folder):
    """Write the traces of all programs into a folder."""
    for name, (program, width, height) in PROGRAMS.items():
        about = {"process.name": name, "license": "MIT, as fixedpipe"}
        with Recorder(Path(folder, f"{name}.trace"), width, height, container="gzip", properties=about) as gl:
            program(gl)


def picture(folder):
    """The picture of the corridor that README shows: uint8 [480, 640, 3]."""
    path, frame = str(Path(folder, "corridor.trace")), 1
    machines = []
    for profile in (OPENGL_1_2, GEFORCE_256):
        (drawn,) = drawn_frames(path, profile, str(frame))
        machines.append(drawn.image[..., :3])
    commands, width, height, _ = frame_of_trace(path, frame, GEFORCE_256)
    ideal = execute_ideal(commands, width, height).image()[..., :3]
    below = np.hstack([ideal, difference_picture(machines[1], ideal)])
    return np.vstack([np.hstack(machines), below])


if __name__ == "__main__":
    write(sys.argv[1])
    Path(sys.argv[1], "corridor.png").write_bytes(png(picture(sys.argv[1])))
