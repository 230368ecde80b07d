"""Runs GLSL on words with Mesa's llvmpipe: the other end of ``mesa.Shaders``.

Run as ``python -m tests.emulators.worker`` with Mesa's environment set. A request is a pickled dict:
``version`` ("330 core" or "310 es"), ``source`` (GLSL of functions and of ``void run(int row)``),
``words_in``, ``words_out`` and ``given``, uint32 [n, words_in]. The answer is uint32 [n, words_out], or a
sentence. The first answer is (renderer, version of OpenGL, version of OpenGL ES).

A fragment reads its row of words from a texture of unsigned integers, and writes up to sixteen words into
four.
"""

import pickle
import sys

import numpy as np
import OpenGL

OpenGL.ERROR_LOGGING = False

from OpenGL import GL  # noqa: E402  the switch above is read when this is imported

from bench.peers.context import make_context  # noqa: E402

WIDTH = 1024  # of textures, in texels of four words
_VERTEX = """\
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
"""
_HEAD = """\
precision highp float;
precision highp int;
uniform highp usampler2D given;
{targets}
uint words[{least}];
uint result[{most}];

uint word(int at) {{
    int texel = at >> 2;
    return texelFetch(given, ivec2(texel % {width}, texel / {width}), 0)[at & 3];
}}
"""
_MAIN = """
void main() {{
    int row = int(gl_FragCoord.y) * {across} + int(gl_FragCoord.x);
    for (int k = 0; k < {words_in}; k++) words[k] = word(row * {words_in} + k);
    run();
{stores}
}}
"""


def fragment_shader(version, source, words_in, words_out):
    """The whole text of a fragment shader; ``source`` has ``void run()``, which makes result of words."""
    count = -(-words_out // 4)
    targets = "\n".join(f"layout(location = {k}) out highp uvec4 target{k};" for k in range(count))
    head = _HEAD.format(targets=targets, least=max(words_in, 1), most=4 * count, width=WIDTH)
    stores = "\n".join(
        f"    target{k} = uvec4({', '.join(f'result[{4 * k + i}]' for i in range(4))});" for k in range(count)
    )
    main = _MAIN.format(across=WIDTH, words_in=words_in, stores=stores)
    return f"#version {version}\n{head}\n{source}\n{main}"


def _compiled(kind, text):
    shader = GL.glCreateShader(kind)
    GL.glShaderSource(shader, text)
    GL.glCompileShader(shader)
    if not GL.glGetShaderiv(shader, GL.GL_COMPILE_STATUS):
        log = GL.glGetShaderInfoLog(shader)
        raise ValueError(f"GLSL does not compile: {log.decode() if isinstance(log, bytes) else log}")
    return shader


def program_of(version, fragment, vertex=_VERTEX):
    """A linked program."""
    program = GL.glCreateProgram()
    shaders = [
        _compiled(GL.GL_VERTEX_SHADER, f"#version {version}\n{vertex}"),
        _compiled(GL.GL_FRAGMENT_SHADER, fragment),
    ]
    for shader in shaders:
        GL.glAttachShader(program, shader)
    GL.glLinkProgram(program)
    if not GL.glGetProgramiv(program, GL.GL_LINK_STATUS):
        raise ValueError(f"GLSL does not link: {GL.glGetProgramInfoLog(program)}")
    for shader in shaders:
        GL.glDeleteShader(shader)
    return program


def _texture(height, data=None):
    name = GL.glGenTextures(1)
    GL.glBindTexture(GL.GL_TEXTURE_2D, name)
    for parameter in (GL.GL_TEXTURE_MIN_FILTER, GL.GL_TEXTURE_MAG_FILTER):
        GL.glTexParameteri(GL.GL_TEXTURE_2D, parameter, GL.GL_NEAREST)
    form = (GL.GL_RGBA32UI, WIDTH, height, 0, GL.GL_RGBA_INTEGER, GL.GL_UNSIGNED_INT)
    GL.glTexImage2D(GL.GL_TEXTURE_2D, 0, *form, data)
    return name


def run(request):
    """A request's answer."""
    given, words_out = request["given"], request["words_out"]
    count, words_in = given.shape
    fragment = fragment_shader(request["version"], request["source"], words_in, words_out)
    program = program_of(request["version"], fragment)
    texels = np.zeros((-(-given.size // (4 * WIDTH)) * WIDTH, 4), np.uint32)
    texels.ravel()[: given.size] = given.ravel()
    height = -(-count // WIDTH)
    source = _texture(len(texels) // WIDTH, texels)
    targets = [_texture(height) for _ in range(-(-words_out // 4))]
    framebuffer = GL.glGenFramebuffers(1)
    GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, framebuffer)
    attachments = [GL.GL_COLOR_ATTACHMENT0 + k for k in range(len(targets))]
    for attachment, target in zip(attachments, targets, strict=True):
        GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, attachment, GL.GL_TEXTURE_2D, target, 0)
    GL.glDrawBuffers(len(attachments), attachments)
    if GL.glCheckFramebufferStatus(GL.GL_FRAMEBUFFER) != GL.GL_FRAMEBUFFER_COMPLETE:
        raise ValueError("the framebuffer object is incomplete")
    GL.glViewport(0, 0, WIDTH, height)
    GL.glUseProgram(program)
    GL.glBindTexture(GL.GL_TEXTURE_2D, source)
    GL.glUniform1i(GL.glGetUniformLocation(program, "given"), 0)
    GL.glDrawArrays(GL.GL_TRIANGLES, 0, 3)
    read = []
    for attachment in attachments:
        GL.glReadBuffer(attachment)
        data = np.empty((height * WIDTH, 4), np.uint32)
        GL.glReadPixels(0, 0, WIDTH, height, GL.GL_RGBA_INTEGER, GL.GL_UNSIGNED_INT, data)
        read.append(data[:count])
    GL.glDeleteTextures([source, *targets])
    GL.glDeleteFramebuffers(1, [framebuffer])
    GL.glDeleteProgram(program)
    error = GL.glGetError()
    if error:
        raise ValueError(f"OpenGL error {error:#x}")
    return np.concatenate(read, axis=1)[:, :words_out]


def _version():
    return GL.glGetString(GL.GL_RENDERER).decode(), GL.glGetString(GL.GL_VERSION).decode()


def main():
    """Answer requests until the input ends."""
    make_context()
    # A context without a vertex array object draws nothing in a core profile; this one is a compatibility
    # context.
    GL.glBindVertexArray(GL.glGenVertexArrays(1))
    out = sys.stdout.buffer
    pickle.dump(_version(), out)
    out.flush()
    while True:
        try:
            request = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            answer = run(request)
        except (ValueError, OpenGL.error.GLError) as error:
            answer = str(error)
        pickle.dump(answer, out)
        out.flush()


if __name__ == "__main__":
    main()
