"""Draws frames of commands with Mesa, through fixed-function OpenGL: the other end of ``mesa.Mesa``.

The picture is drawn upside down and turned over when it is read: of pixels whose centres lie on a horizontal
edge Mesa draws those of a polygon's lower edge (Measured, both drivers), a chip of the time those of the
upper, and OpenGL allows either. With y turned the two rules are one.

Run as ``python -m tests.opengl.worker`` with Mesa's environment set. A request is a pickled list of frames,
(width, height, commands); the answer a list of {"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil":
uint8 [h, w]}, top row first, or a sentence. The first answer is (renderer, version).
"""

import os
import pickle
import sys
from dataclasses import fields, replace

import numpy as np
import OpenGL

OpenGL.ERROR_CHECKING = False
OpenGL.ERROR_LOGGING = False

from OpenGL import GL  # noqa: E402  the two switches above are read when this is imported

from bench.peers.context import make_context  # noqa: E402
from fixedpipe.pipeline.commands import Clear, Draw, TexImage  # noqa: E402
from fixedpipe.pipeline.enums import (  # noqa: E402
    Face,
    FrontFace,
    PrimitiveType,
    ProvokingVertex,
    TexGenMode,
    TextureEnvironmentMode,
    TextureTarget,
)
from fixedpipe.pipeline.state import IDENTITY, PassState, TextureUnit, Viewport  # noqa: E402

_TARGETS = {
    TextureTarget.TEXTURE_1D: GL.GL_TEXTURE_1D,
    TextureTarget.TEXTURE_2D: GL.GL_TEXTURE_2D,
    TextureTarget.TEXTURE_3D: GL.GL_TEXTURE_3D,
    TextureTarget.TEXTURE_CUBE_MAP: GL.GL_TEXTURE_CUBE_MAP,
}
# Section 3.5.5 leaves r, the smallest difference that is certain to show, to the implementation: ours is one
# unit of the depth buffer, Mesa's two. Measured: 1000 units move a 24-bit depth by 2000, with both drivers.
_SMALLEST_DIFFERENCE = 2.0
_COMBINE4 = 0x8503  # Source: NV_texture_env_combine4, New Tokens
_SINGLE_PRIMITIVES = (PrimitiveType.TRIANGLES, PrimitiveType.QUADS, PrimitiveType.POINTS, PrimitiveType.LINES)


def _token(member):
    return getattr(GL, f"GL_{member.name}")


def _switch(capability, enabled):
    (GL.glEnable if enabled else GL.glDisable)(capability)


def _defaults(state, names):
    """The state with those fields as a new one has them: what is then left unequal is not translated."""
    fresh = type(state)(*((None,) if isinstance(state, TextureUnit) else ()))
    return replace(state, **{name: getattr(fresh, name) for name in names if name in _names(state)})


def _names(state):
    return {f.name for f in fields(state)}


_VERTEX = ("modelview", "projection", "normalize", "rescale_normal", "clip_planes", "lighting")
_POLYGON = (
    "cull_face",
    "front_face",
    "offset_fill",
    "offset_line",
    "offset_point",
    "offset_factor",
    "offset_units",
    "shade_model",
    "provoking_vertex",
    "front_mode",
    "back_mode",
    "stipple",
)
_SAMPLER = (
    *("min_filter", "mag_filter", "wrap_s", "wrap_t", "wrap_r", "border_color", "min_lod", "max_lod"),
    *("max_level", "base_level", "compare_mode", "compare_function"),
)
_PASS = (
    *("color_sum", "fog", "scissor", "alpha_test", "stencil_test", "depth_test", "blending", "logic_op"),
    "color_mask",
)


def _check_translated(state):
    """Raises ValueError where a state sets what ``_Painter`` does not translate."""
    rest = _defaults(state, _PASS)
    rest = replace(
        rest,
        vertex=_defaults(replace(rest.vertex, viewport=Viewport()), _VERTEX),
        polygon=_defaults(rest.polygon, _POLYGON),
        point=_defaults(rest.point, ("size",)),
        line=_defaults(rest.line, ("width", "rasterization", "stipple")),
        texture_units=(),
    )
    if rest != PassState():
        raise ValueError(f"the worker does not translate all of {rest}")
    for unit in state.texture_units:
        if unit is not None:
            left = _defaults(unit, ("texture", "lod_bias", "coordinates", "gen", "matrix", "environment"))
            if replace(left, sampler=_defaults(unit.sampler, _SAMPLER)) != TextureUnit(None):
                raise ValueError(f"the worker does not translate all of {unit}")


def _load(mode, matrix):
    GL.glMatrixMode(mode)
    GL.glLoadMatrixd([row[column] for column in range(4) for row in matrix])


class _Painter:
    """One frame in a framebuffer object of RGBA8 and 24-bit depth with 8-bit stencil."""

    def __init__(self, width, height):
        self.width, self.height = width, height
        self.framebuffer = GL.glGenFramebuffers(1)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.framebuffer)
        formats = (GL.GL_RGBA8, GL.GL_DEPTH24_STENCIL8)
        attachments = (GL.GL_COLOR_ATTACHMENT0, GL.GL_DEPTH_STENCIL_ATTACHMENT)
        for internal, attachment in zip(formats, attachments, strict=True):
            name = GL.glGenRenderbuffers(1)
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, name)
            GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, internal, width, height)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, attachment, GL.GL_RENDERBUFFER, name)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            raise OSError("the framebuffer object is incomplete")
        self.textures = {}

    def paint(self, commands):
        """Draw the commands on a framebuffer of zeros and the farthest depth, and read it."""
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self.framebuffer)
        GL.glPushAttrib(GL.GL_ALL_ATTRIB_BITS)
        try:
            GL.glDisable(GL.GL_DITHER)
            self.clear(Clear(label="new", color=(0.0, 0.0, 0.0, 0.0), depth=1.0, stencil=0))
            for command in commands:
                GL.glPushAttrib(GL.GL_ALL_ATTRIB_BITS)
                {Clear: self.clear, Draw: self.draw, TexImage: self.tex_image}[type(command)](command)
                GL.glPopAttrib()
                # softpipe keeps colours above one until it writes its tiles back. Measured: docs/mesa.md.
                GL.glFinish()
            answer = self.read()
        finally:
            GL.glPopAttrib()
            if self.textures:
                GL.glDeleteTextures([name for name, _ in self.textures.values()])
            self.textures = {}
        error = GL.glGetError()
        if error:
            raise ValueError(f"OpenGL error {error:#x}")
        return answer

    def read(self):
        """What the framebuffer holds; its lowest row is the picture's top one."""
        size = (self.height, self.width)

        def pixels(pixel_format, pixel_type, dtype):
            data = GL.glReadPixels(0, 0, self.width, self.height, pixel_format, pixel_type, outputType=bytes)
            return np.frombuffer(data, dtype)

        # Depth arrives widened from 24 to 32 bits; the upper 24 are what is stored.
        depth = pixels(GL.GL_DEPTH_COMPONENT, GL.GL_UNSIGNED_INT, np.uint32) >> 8
        stencil = pixels(GL.GL_STENCIL_INDEX, GL.GL_UNSIGNED_BYTE, np.uint8)
        color = pixels(GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.uint8)
        return {
            "color": color.reshape(*size, 4),
            "depth": depth.reshape(size),
            "stencil": stencil.reshape(size),
        }

    # ------------------------------------------------------------------------------------------- commands

    def scissor(self, scissor):
        _switch(GL.GL_SCISSOR_TEST, scissor is not None)
        if scissor is not None:
            turned = self.height - scissor.y - scissor.height
            GL.glScissor(scissor.x, turned, scissor.width, scissor.height)

    def clear(self, command):
        self.scissor(command.scissor)
        bits = 0
        if command.color is not None:
            bits |= GL.GL_COLOR_BUFFER_BIT
            GL.glClearColor(*command.color)
            mask = command.color_mask
            GL.glColorMask(mask.red, mask.green, mask.blue, mask.alpha)
        if command.depth is not None:
            bits |= GL.GL_DEPTH_BUFFER_BIT
            GL.glClearDepth(command.depth)
        if command.stencil is not None:
            bits |= GL.GL_STENCIL_BUFFER_BIT
            GL.glClearStencil(command.stencil)
            GL.glStencilMask(command.stencil_write_mask)
        GL.glClear(bits)

    def tex_image(self, command):
        image, target = command.image, _TARGETS[command.image.target]
        name = GL.glGenTextures(1)
        if command.texture in self.textures:
            GL.glDeleteTextures([self.textures[command.texture][0]])
        self.textures[command.texture] = name, target
        GL.glBindTexture(target, name)
        GL.glPixelStorei(GL.GL_UNPACK_ALIGNMENT, 1)
        internal = _token(image.internal_format)
        for level, faces in enumerate(image.levels):
            depth, height, width = faces.shape[:3]
            data = (GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.ascontiguousarray(faces).tobytes())
            if target == GL.GL_TEXTURE_1D:
                GL.glTexImage1D(target, level, internal, width, 0, *data)
            elif target == GL.GL_TEXTURE_3D:
                GL.glTexImage3D(target, level, internal, width, height, depth, 0, *data)
            elif target == GL.GL_TEXTURE_2D:
                GL.glTexImage2D(target, level, internal, width, height, 0, *data)
            else:
                for face, texels in enumerate(faces):
                    data = (GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.ascontiguousarray(texels).tobytes())
                    face_target = GL.GL_TEXTURE_CUBE_MAP_POSITIVE_X + face
                    GL.glTexImage2D(face_target, level, internal, width, height, 0, *data)

    def draw(self, command):
        state = command.state
        _check_translated(state)
        view = state.vertex.viewport
        size = (
            self.width if view.width is None else view.width,
            self.height if view.height is None else view.height,
        )
        GL.glViewport(view.x, self.height - view.y - size[1], *size)
        GL.glDepthRange(view.near, view.far)
        self.vertex_state(state.vertex)
        self.polygon_state(state.polygon)
        GL.glPointSize(state.point.size)
        GL.glLineWidth(state.line.width)
        self.texture_units(state.texture_units)
        _switch(GL.GL_COLOR_SUM, state.color_sum)
        self.fog(state.fog)
        self.per_fragment(state)
        x, y, z, w = state.vertex.projection
        _load(GL.GL_PROJECTION, (x, tuple(-v for v in y), z, w))
        _load(GL.GL_MODELVIEW, state.vertex.modelview)
        self.mesh(command.mesh, state)

    # --------------------------------------------------------------------------------------------- states

    def vertex_state(self, vertex):
        """What is given in eye coordinates, while the modelview matrix is the identity."""
        _load(GL.GL_MODELVIEW, IDENTITY)
        _switch(GL.GL_NORMALIZE, vertex.normalize)
        _switch(GL.GL_RESCALE_NORMAL, vertex.rescale_normal)
        for i, plane in enumerate(vertex.clip_planes):
            GL.glClipPlane(GL.GL_CLIP_PLANE0 + i, plane)
            GL.glEnable(GL.GL_CLIP_PLANE0 + i)
        if vertex.lighting is not None:
            self.lighting(vertex.lighting)

    def lighting(self, lighting):
        GL.glEnable(GL.GL_LIGHTING)
        GL.glLightModelfv(GL.GL_LIGHT_MODEL_AMBIENT, lighting.model_ambient)
        GL.glLightModeli(GL.GL_LIGHT_MODEL_LOCAL_VIEWER, lighting.local_viewer)
        GL.glLightModeli(GL.GL_LIGHT_MODEL_TWO_SIDE, lighting.two_side)
        control = GL.GL_SEPARATE_SPECULAR_COLOR if lighting.separate_specular_color else GL.GL_SINGLE_COLOR
        GL.glLightModeli(GL.GL_LIGHT_MODEL_COLOR_CONTROL, control)
        for face, material in ((GL.GL_FRONT, lighting.front), (GL.GL_BACK, lighting.back)):
            for name in ("ambient", "diffuse", "specular", "emission"):
                GL.glMaterialfv(face, getattr(GL, f"GL_{name.upper()}"), getattr(material, name))
            GL.glMaterialf(face, GL.GL_SHININESS, material.shininess)
        for i, light in enumerate(lighting.lights):
            which = GL.GL_LIGHT0 + i
            for name in ("ambient", "diffuse", "specular", "position"):
                GL.glLightfv(which, getattr(GL, f"GL_{name.upper()}"), getattr(light, name))
            GL.glLightfv(which, GL.GL_SPOT_DIRECTION, light.spot_direction)
            for name in ("spot_exponent", "spot_cutoff"):
                GL.glLightf(which, getattr(GL, f"GL_{name.upper()}"), getattr(light, name))
            for name in ("constant_attenuation", "linear_attenuation", "quadratic_attenuation"):
                GL.glLightf(which, getattr(GL, f"GL_{name.upper()}"), getattr(light, name))
            GL.glEnable(which)
        if lighting.color_material is not None:
            GL.glColorMaterial(
                _token(lighting.color_material.face), _token(lighting.color_material.parameter)
            )
            GL.glEnable(GL.GL_COLOR_MATERIAL)

    def polygon_state(self, polygon):
        _switch(GL.GL_CULL_FACE, polygon.cull_face is not None)
        if polygon.cull_face is not None:
            GL.glCullFace(_token(polygon.cull_face))
        counter_clockwise = polygon.front_face is FrontFace.CCW
        GL.glFrontFace(GL.GL_CW if counter_clockwise else GL.GL_CCW)
        _switch(GL.GL_POLYGON_OFFSET_FILL, polygon.offset_fill)
        _switch(GL.GL_POLYGON_OFFSET_LINE, polygon.offset_line)
        _switch(GL.GL_POLYGON_OFFSET_POINT, polygon.offset_point)
        GL.glPolygonOffset(polygon.offset_factor, polygon.offset_units / _SMALLEST_DIFFERENCE)
        GL.glShadeModel(_token(polygon.shade_model))
        first = polygon.provoking_vertex is ProvokingVertex.FIRST
        GL.glProvokingVertex(GL.GL_FIRST_VERTEX_CONVENTION if first else GL.GL_LAST_VERTEX_CONVENTION)
        GL.glPolygonMode(_token(Face.FRONT), _token(polygon.front_mode))
        GL.glPolygonMode(_token(Face.BACK), _token(polygon.back_mode))
        _switch(GL.GL_POLYGON_STIPPLE, polygon.stipple is not None)
        if polygon.stipple is not None:
            rows = [polygon.stipple[4 * y : 4 * y + 4] for y in range(32)]
            turned = [rows[(self.height - 1 - y) % 32] for y in range(32)]
            GL.glPolygonStipple(b"".join(turned))

    def texture_units(self, units):
        for i, unit in enumerate(units):
            if unit is None:
                continue
            GL.glActiveTexture(GL.GL_TEXTURE0 + i)
            name, target = self.textures[unit.texture]
            GL.glBindTexture(target, name)
            GL.glEnable(target)
            self.sampler(unit.sampler, target)
            GL.glTexEnvf(GL.GL_TEXTURE_FILTER_CONTROL, GL.GL_TEXTURE_LOD_BIAS, unit.lod_bias)
            _load(GL.GL_TEXTURE, unit.matrix)
            self.environment(unit.environment)
            for coordinate, gen in zip("STRQ", unit.gen, strict=True):
                self.generation(coordinate, gen)

    def environment(self, environment):
        def set_to(parameter, value):
            GL.glTexEnvi(GL.GL_TEXTURE_ENV, parameter, value)

        combine4 = environment.mode is TextureEnvironmentMode.COMBINE4
        mode = _COMBINE4 if combine4 else _token(environment.mode)
        set_to(GL.GL_TEXTURE_ENV_MODE, mode)
        GL.glTexEnvfv(GL.GL_TEXTURE_ENV, GL.GL_TEXTURE_ENV_COLOR, environment.color)
        if environment.mode not in (TextureEnvironmentMode.COMBINE, TextureEnvironmentMode.COMBINE4):
            return
        for half, function, source, operand, scale in (
            (environment.rgb, GL.GL_COMBINE_RGB, GL.GL_SRC0_RGB, GL.GL_OPERAND0_RGB, GL.GL_RGB_SCALE),
            (
                environment.alpha,
                GL.GL_COMBINE_ALPHA,
                GL.GL_SRC0_ALPHA,
                GL.GL_OPERAND0_ALPHA,
                GL.GL_ALPHA_SCALE,
            ),
        ):
            set_to(function, _token(half.function))
            count = 4 if combine4 else 3  # the tokens of a half's arguments follow each other
            for i in range(count):
                if i < len(half.sources):
                    set_to(source + i, _token(half.sources[i]))
                if i < len(half.operands):
                    set_to(operand + i, _token(half.operands[i]))
            GL.glTexEnvf(GL.GL_TEXTURE_ENV, scale, half.scale)

    def sampler(self, sampler, target):
        for name in ("min_filter", "mag_filter", "wrap_s", "wrap_t", "wrap_r"):
            GL.glTexParameteri(
                target, getattr(GL, f"GL_TEXTURE_{name.upper()}"), _token(getattr(sampler, name))
            )
        for name in ("min_lod", "max_lod"):
            GL.glTexParameterf(target, getattr(GL, f"GL_TEXTURE_{name.upper()}"), getattr(sampler, name))
        GL.glTexParameteri(target, GL.GL_TEXTURE_MAX_LEVEL, sampler.max_level)
        GL.glTexParameteri(target, GL.GL_TEXTURE_BASE_LEVEL, sampler.base_level)
        GL.glTexParameterfv(target, GL.GL_TEXTURE_BORDER_COLOR, sampler.border_color)

    def generation(self, coordinate, gen):
        which = getattr(GL, f"GL_{coordinate}")
        _switch(getattr(GL, f"GL_TEXTURE_GEN_{coordinate}"), gen.mode is not TexGenMode.NONE)
        if gen.mode is TexGenMode.NONE:
            return
        GL.glTexGeni(which, GL.GL_TEXTURE_GEN_MODE, _token(gen.mode))
        if gen.mode in (TexGenMode.OBJECT_LINEAR, TexGenMode.EYE_LINEAR):
            plane = GL.GL_OBJECT_PLANE if gen.mode is TexGenMode.OBJECT_LINEAR else GL.GL_EYE_PLANE
            GL.glMatrixMode(GL.GL_MODELVIEW)
            GL.glTexGenfv(which, plane, gen.plane)

    def fog(self, fog):
        _switch(GL.GL_FOG, fog is not None)
        if fog is not None:
            GL.glFogi(GL.GL_FOG_MODE, _token(fog.mode))
            GL.glFogf(GL.GL_FOG_DENSITY, fog.density)
            GL.glFogf(GL.GL_FOG_START, fog.start)
            GL.glFogf(GL.GL_FOG_END, fog.end)
            GL.glFogfv(GL.GL_FOG_COLOR, fog.color)
            GL.glFogi(GL.GL_FOG_COORD_SRC, _token(fog.coordinate_source))

    def per_fragment(self, state):
        self.scissor(state.scissor)
        _switch(GL.GL_ALPHA_TEST, state.alpha_test is not None)
        if state.alpha_test is not None:
            GL.glAlphaFunc(_token(state.alpha_test.function), state.alpha_test.reference)
        test = state.stencil_test
        _switch(GL.GL_STENCIL_TEST, test is not None)
        if test is not None:
            GL.glStencilFunc(_token(test.function), test.reference, test.mask)
            GL.glStencilOp(_token(test.fail), _token(test.depth_fail), _token(test.depth_pass))
            GL.glStencilMask(test.write_mask)
        _switch(GL.GL_DEPTH_TEST, state.depth_test is not None)
        if state.depth_test is not None:
            GL.glDepthFunc(_token(state.depth_test.function))
            GL.glDepthMask(state.depth_test.write)
        blending = state.blending
        _switch(GL.GL_BLEND, blending is not None)
        if blending is not None:
            GL.glBlendFunc(_token(blending.source), _token(blending.destination))
            GL.glBlendEquation(getattr(GL, f"GL_{blending.equation.name}"))
            GL.glBlendColor(*blending.color)
        _switch(GL.GL_COLOR_LOGIC_OP, state.logic_op is not None)
        if state.logic_op is not None:
            GL.glLogicOp(_token(state.logic_op))
        mask = state.color_mask
        GL.glColorMask(mask.red, mask.green, mask.blue, mask.alpha)

    # ------------------------------------------------------------------------------------------- vertices

    def mesh(self, mesh, state):
        order = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
        counts = mesh.counts or (len(order),)
        if mesh.primitive in _SINGLE_PRIMITIVES:
            counts = (len(order),)
        rows = _rows(mesh, [u.coordinates if u is not None else None for u in state.texture_units])
        start = 0
        for count in counts:
            GL.glBegin(_token(mesh.primitive))
            for vertex in order[start : start + count].tolist():
                for call, values in rows[vertex]:
                    call(*values)
            GL.glEnd()
            start += count


def _rows(mesh, sets):
    """The calls that hand over each vertex, its position last."""
    columns = []

    def column(call, values):
        columns.append([(call, row) for row in values])

    count = len(mesh.positions)
    colors = np.ones((count, 4)) if mesh.colors is None else mesh.colors
    column(GL.glColor4f if colors.shape[1] == 4 else GL.glColor3f, colors.tolist())
    secondary = np.zeros((count, 3)) if mesh.secondary_colors is None else mesh.secondary_colors
    column(GL.glSecondaryColor3f, secondary[:, :3].tolist())
    normals = np.tile([0.0, 0.0, 1.0], (count, 1)) if mesh.normals is None else mesh.normals
    column(GL.glNormal3f, normals.tolist())
    fog = np.zeros(count) if mesh.fog_coordinates is None else mesh.fog_coordinates
    column(GL.glFogCoordf, fog[:, None].tolist())
    flags = np.ones(count, bool) if mesh.edge_flags is None else mesh.edge_flags
    column(GL.glEdgeFlag, flags[:, None].tolist())
    for i, which in enumerate(sets):
        if which is not None:
            coordinates = _widened(
                mesh.texture_coordinates[which] if mesh.texture_coordinates else np.zeros((count, 1))
            )
            column(GL.glMultiTexCoord4f, [(GL.GL_TEXTURE0 + i, *row) for row in coordinates.tolist()])
    column(GL.glVertex4f, _widened(mesh.positions).tolist())
    return list(zip(*columns, strict=True))


def _widened(values):
    """(x, 0, 0, 1) and the like with four components."""
    full = np.tile([0.0, 0.0, 0.0, 1.0], (len(values), 1))
    full[:, : values.shape[1]] = values
    return full


def _serve(requests, answers):
    def answer(what):
        pickle.dump(what, answers)
        answers.flush()

    try:
        make_context()
    except OSError as problem:
        answer(str(problem))
        return
    answer(tuple(GL.glGetString(what).decode() for what in (GL.GL_RENDERER, GL.GL_VERSION)))
    painters = {}
    while True:
        try:
            frames = pickle.load(requests)
        except EOFError:
            return
        try:
            pictures = []
            for *size, commands in frames:
                if tuple(size) not in painters:
                    painters[tuple(size)] = _Painter(*size)
                pictures.append(painters[tuple(size)].paint(commands))
            answer(pictures)
        except (OSError, ValueError) as problem:
            answer(str(problem))


if __name__ == "__main__":
    # Whatever a library prints must not end up among the answers.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    _serve(sys.stdin.buffer, answers)
