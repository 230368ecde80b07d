"""Draws the scenes with fixed-function OpenGL, headless, on request: the other end of ``OpenGLPeer``.

Run as ``python -m bench.peers.opengl_worker`` with Mesa's environment set. Requests and answers are one JSON
object a line, on standard input and output: {"do": "prepare", "scene", "size"}, {"do": "turn", "frames"} with
the answer {"seconds"}, {"do": "picture", "file"}. An answer with "error" ends the conversation.
"""

import ctypes
import json
import os
import sys
from dataclasses import replace

import numpy as np
import OpenGL

OpenGL.ERROR_CHECKING = False
OpenGL.ERROR_LOGGING = False

from OpenGL import GL  # noqa: E402  the two switches above are read when this is imported

from bench.measure import clock_of  # noqa: E402
from bench.peers.context import make_context  # noqa: E402
from bench.peers.mesa import own_threads  # noqa: E402
from bench.scenes import CLEAR_COLOR, SCENES  # noqa: E402
from bench.textures import TEXTURES  # noqa: E402
from fixedpipe.pipeline.enums import InternalFormat, TexGenMode, TextureCompareMode  # noqa: E402
from fixedpipe.pipeline.state import IDENTITY, ColorMask, PassState, Sampler, TexGen, TextureUnit  # noqa: E402


def untranslated(state):
    """What is left of a PassState when everything that ``Stage`` translates is at its default."""
    return replace(
        state,
        vertex=replace(state.vertex, modelview=IDENTITY, projection=IDENTITY),
        polygon=replace(state.polygon, cull_face=None),
        texture_units=(),
        register_combiners=None,
        stencil_test=None,
        depth_test=None,
        blending=None,
        color_mask=ColorMask(),
    )


def untranslated_unit(unit):
    """What is left of a TextureUnit when everything that ``Stage`` translates is at its default.

    Of the coordinates' generation OBJECT_LINEAR is.
    """
    default = Sampler()
    names = ("min_filter", "mag_filter", "wrap_s", "wrap_t", "compare_mode", "compare_function")
    kept = (TexGen() if gen.mode is TexGenMode.OBJECT_LINEAR else gen for gen in unit.gen)
    return replace(
        unit,
        texture=None,
        sampler=replace(unit.sampler, **{name: getattr(default, name) for name in names}),
        coordinates=0,
        gen=tuple(kept),
    )


def _token(member):
    return getattr(GL, f"GL_{member.name}")


def _upload_level(internal_format, level, texels):
    """``texels``: uint8 [h, w, 4] of RGBA8 or DEPTH_COMPONENT24."""
    height, width = texels.shape[:2]
    pixel_format, pixel_type = GL.GL_RGBA, GL.GL_UNSIGNED_BYTE
    if internal_format is InternalFormat.DEPTH_COMPONENT24:
        pixel_format, pixel_type = GL.GL_DEPTH_COMPONENT, GL.GL_UNSIGNED_INT
        words = np.ascontiguousarray(texels).view("<u4")
        texels = words << 8 | words >> 16  # the same fraction of 2^32 - 1
    GL.glTexImage2D(
        GL.GL_TEXTURE_2D,
        level,
        _token(internal_format),
        width,
        height,
        0,
        pixel_format,
        pixel_type,
        texels.tobytes(),
    )


class Stage:
    """One scene in a framebuffer object of RGBA8 and 24-bit depth with 8-bit stencil."""

    def __init__(self, scene, size):
        self._scene, self._size = scene, size
        self._framebuffer = GL.glGenFramebuffers(1)
        self._renderbuffers = GL.glGenRenderbuffers(2)
        self._textures, self._buffers, self._arrays = [], [], []
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        formats = (GL.GL_RGBA8, GL.GL_DEPTH24_STENCIL8)
        attachments = (GL.GL_COLOR_ATTACHMENT0, GL.GL_DEPTH_STENCIL_ATTACHMENT)
        for name, internal, attachment in zip(self._renderbuffers, formats, attachments, strict=True):
            GL.glBindRenderbuffer(GL.GL_RENDERBUFFER, name)
            GL.glRenderbufferStorage(GL.GL_RENDERBUFFER, internal, size, size)
            GL.glFramebufferRenderbuffer(GL.GL_FRAMEBUFFER, attachment, GL.GL_RENDERBUFFER, name)
        if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
            raise OSError("the framebuffer object is incomplete")
        layer = scene.layer(size)
        state = layer[0].state
        left = [untranslated_unit(unit) for unit in state.texture_units]
        if untranslated(state) != PassState() or any(unit != TextureUnit(None) for unit in left):
            raise ValueError(f"scene {scene.name} sets state that this worker does not translate")
        GL.glPushAttrib(GL.GL_ALL_ATTRIB_BITS)
        GL.glViewport(0, 0, size, size)
        GL.glDisable(GL.GL_DITHER)
        GL.glClearColor(*CLEAR_COLOR)
        self._translate(state)
        self._draws = [self._upload(draw.mesh, state) for draw in layer]
        error = GL.glGetError()
        if error:
            raise OSError(f"scene {scene.name}: OpenGL error {error:#x}")

    def _translate(self, state):
        for mode, matrix in (
            (GL.GL_PROJECTION, state.vertex.projection),
            (GL.GL_MODELVIEW, state.vertex.modelview),
        ):
            GL.glMatrixMode(mode)
            GL.glLoadMatrixd([row[column] for column in range(4) for row in matrix])
        if state.polygon.cull_face is not None:
            GL.glEnable(GL.GL_CULL_FACE)
            GL.glCullFace(_token(state.polygon.cull_face))
        self._depth_write = True
        if state.depth_test:
            GL.glEnable(GL.GL_DEPTH_TEST)
            self._depth_function = _token(state.depth_test.function)
            GL.glDepthFunc(self._depth_function)
            self._depth_write = state.depth_test.write
        if state.stencil_test:
            test = state.stencil_test
            GL.glEnable(GL.GL_STENCIL_TEST)
            GL.glStencilFunc(_token(test.function), test.reference, test.mask)
            GL.glStencilOp(_token(test.fail), _token(test.depth_fail), _token(test.depth_pass))
            GL.glStencilMask(test.write_mask)
        if state.blending:
            GL.glEnable(GL.GL_BLEND)
            GL.glBlendFunc(_token(state.blending.source), _token(state.blending.destination))
            GL.glBlendEquation(getattr(GL, f"GL_{state.blending.equation.name}"))
        mask = state.color_mask
        self._color_mask = (mask.red, mask.green, mask.blue, mask.alpha)
        for number, unit in enumerate(state.texture_units):
            self._texture_unit(number, unit, self._scene.environments[number])

    def _texture_unit(self, number, unit, environment):
        GL.glActiveTexture(GL.GL_TEXTURE0 + number)
        name = GL.glGenTextures(1)
        self._textures.append(name)
        GL.glBindTexture(GL.GL_TEXTURE_2D, name)
        sampler, target = unit.sampler, GL.GL_TEXTURE_2D
        GL.glTexParameteri(target, GL.GL_TEXTURE_MAG_FILTER, _token(sampler.mag_filter))
        GL.glTexParameteri(target, GL.GL_TEXTURE_MIN_FILTER, _token(sampler.min_filter))
        GL.glTexParameteri(target, GL.GL_TEXTURE_WRAP_S, _token(sampler.wrap_s))
        GL.glTexParameteri(target, GL.GL_TEXTURE_WRAP_T, _token(sampler.wrap_t))
        if sampler.compare_mode is not TextureCompareMode.NONE:
            GL.glTexParameteri(target, GL.GL_TEXTURE_COMPARE_MODE, _token(sampler.compare_mode))
            GL.glTexParameteri(target, GL.GL_TEXTURE_COMPARE_FUNC, _token(sampler.compare_function))
            # Ours gives the comparison's result in all four components.
            GL.glTexParameteri(target, GL.GL_DEPTH_TEXTURE_MODE, GL.GL_INTENSITY)
        image = TEXTURES[unit.texture]()
        for level, (texels,) in enumerate(image.levels):
            _upload_level(image.internal_format, level, texels)
        GL.glEnable(target)
        for name, gen in zip("STRQ", unit.gen, strict=True):
            if gen.mode is TexGenMode.OBJECT_LINEAR:
                coordinate = getattr(GL, f"GL_{name}")
                GL.glTexGeni(coordinate, GL.GL_TEXTURE_GEN_MODE, GL.GL_OBJECT_LINEAR)
                GL.glTexGenfv(coordinate, GL.GL_OBJECT_PLANE, gen.plane)
                GL.glEnable(getattr(GL, f"GL_TEXTURE_GEN_{name}"))
        settings = [(GL.GL_TEXTURE_ENV_MODE, GL.GL_MODULATE)]
        if environment == "DOT3":
            settings = [
                (GL.GL_TEXTURE_ENV_MODE, GL.GL_COMBINE),
                (GL.GL_COMBINE_RGB, GL.GL_DOT3_RGB),
                (GL.GL_SRC0_RGB, GL.GL_TEXTURE),
                (GL.GL_SRC1_RGB, GL.GL_PRIMARY_COLOR),
                (GL.GL_COMBINE_ALPHA, GL.GL_REPLACE),
                (GL.GL_SRC0_ALPHA, GL.GL_TEXTURE),
            ]
        for parameter, value in settings:
            GL.glTexEnvi(GL.GL_TEXTURE_ENV, parameter, value)

    def _upload(self, mesh, state):
        """Put a mesh into buffers; the function that draws it."""
        arrays = GL.glGenVertexArrays(1)
        self._arrays.append(arrays)
        GL.glBindVertexArray(arrays)
        offset = ctypes.c_void_p(0)
        self._buffer(GL.GL_ARRAY_BUFFER, mesh.positions, np.float32)
        GL.glVertexPointer(mesh.positions.shape[1], GL.GL_FLOAT, 0, offset)
        GL.glEnableClientState(GL.GL_VERTEX_ARRAY)
        if mesh.colors is None or (mesh.colors == mesh.colors[0]).all():
            GL.glColor4f(*((1.0, 1.0, 1.0, 1.0) if mesh.colors is None else mesh.colors[0]))
        else:
            self._buffer(GL.GL_ARRAY_BUFFER, mesh.colors, np.float32)
            GL.glColorPointer(4, GL.GL_FLOAT, 0, offset)
            GL.glEnableClientState(GL.GL_COLOR_ARRAY)
        for number, unit in enumerate(state.texture_units):
            if all(gen.mode is not TexGenMode.NONE for gen in unit.gen):
                continue
            coordinates = mesh.texture_coordinates[unit.coordinates]
            GL.glClientActiveTexture(GL.GL_TEXTURE0 + number)
            self._buffer(GL.GL_ARRAY_BUFFER, coordinates, np.float32)
            GL.glTexCoordPointer(coordinates.shape[1], GL.GL_FLOAT, 0, offset)
            GL.glEnableClientState(GL.GL_TEXTURE_COORD_ARRAY)
        primitive, indices = _token(mesh.primitive), mesh.indices
        count = len(mesh.positions if indices is None else indices)
        if indices is not None:
            self._buffer(GL.GL_ELEMENT_ARRAY_BUFFER, indices, np.uint32)

        def draw():
            GL.glBindVertexArray(arrays)
            if indices is None:
                GL.glDrawArrays(primitive, 0, count)
            else:
                GL.glDrawElements(primitive, count, GL.GL_UNSIGNED_INT, offset)

        return draw

    def _buffer(self, target, array, dtype):
        data = np.ascontiguousarray(array, dtype).tobytes()
        name = GL.glGenBuffers(1)
        self._buffers.append(name)
        GL.glBindBuffer(target, name)
        GL.glBufferData(target, len(data), data, GL.GL_STATIC_DRAW)

    def frame(self, layers):
        """Clear everything, draw depths where they come first, then ``layers`` times; wait for the end."""
        GL.glColorMask(True, True, True, True)
        GL.glDepthMask(True)
        GL.glClear(GL.GL_COLOR_BUFFER_BIT | GL.GL_DEPTH_BUFFER_BIT | GL.GL_STENCIL_BUFFER_BIT)
        if self._scene.depth_first:
            self._draw_depths()
        GL.glColorMask(*self._color_mask)
        GL.glDepthMask(self._depth_write)
        for draw in self._draws * layers:
            draw()
        GL.glFinish()

    def _draw_depths(self):
        GL.glColorMask(False, False, False, False)
        GL.glDepthFunc(GL.GL_LESS)
        self._switch_textures(GL.glDisable)
        for draw in self._draws:
            draw()
        self._switch_textures(GL.glEnable)
        GL.glDepthFunc(self._depth_function)

    def _switch_textures(self, switch):
        for number in range(len(self._textures)):
            GL.glActiveTexture(GL.GL_TEXTURE0 + number)
            switch(GL.GL_TEXTURE_2D)

    def turn(self, frames):
        """Seconds that ``frames`` measured frames took."""
        clock = clock_of(own_threads())
        start = clock()
        for _ in range(frames):
            self.frame(self._scene.layers)
        return clock() - start

    def picture(self):
        """Draw the compared picture: color [h, w, 4], depth and stencil [h, w], top row first."""
        self.frame(self._scene.picture_layers)
        # Depth arrives widened from 24 to 32 bits; the upper 24 are what is stored.
        depth = self._read(GL.GL_DEPTH_COMPONENT, GL.GL_UNSIGNED_INT, np.uint32) >> 8
        stencil = self._read(GL.GL_STENCIL_INDEX, GL.GL_UNSIGNED_BYTE, np.uint8)
        color = self._read(GL.GL_RGBA, GL.GL_UNSIGNED_BYTE, np.uint8).reshape(self._size, self._size, 4)
        return {"color": color, "depth": depth, "stencil": stencil}

    def _read(self, pixel_format, pixel_type, dtype):
        pixels = GL.glReadPixels(0, 0, self._size, self._size, pixel_format, pixel_type, outputType=bytes)
        return np.frombuffer(pixels, dtype).reshape(self._size, -1)[::-1]

    def close(self):
        """Give everything back and restore the context's initial state."""
        GL.glPopAttrib()
        GL.glDeleteVertexArrays(len(self._arrays), self._arrays)
        GL.glDeleteBuffers(len(self._buffers), self._buffers)
        GL.glDeleteTextures(self._textures)
        GL.glDeleteFramebuffers(1, [self._framebuffer])
        GL.glDeleteRenderbuffers(2, self._renderbuffers)


def _serve(requests, answers):
    def answer(**what):
        print(json.dumps(what), file=answers, flush=True)

    try:
        make_context()
        renderer, version = (GL.glGetString(what).decode() for what in (GL.GL_RENDERER, GL.GL_VERSION))
        answer(renderer=renderer, version=version)
        stage = None
        for line in requests:
            request = json.loads(line)
            if request["do"] == "prepare":
                if stage:
                    stage.close()
                stage = Stage(SCENES[request["scene"]], request["size"])
                answer()
            elif request["do"] == "turn":
                answer(seconds=stage.turn(request["frames"]))
            elif request["do"] == "picture":
                np.savez(request["file"], **stage.picture())
                answer()
    except (OSError, ValueError) as problem:
        answer(error=str(problem))


if __name__ == "__main__":
    # Whatever a library prints must not end up among the answers.
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    _serve(sys.stdin, answers)
