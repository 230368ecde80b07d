"""An OpenGL context without a display, from EGL: the one way in which Mesa is reached here."""

import ctypes

# Source: EGL 1.5 registry, EGL_MESA_platform_surfaceless.
_PLATFORM_SURFACELESS, _OPENGL_API = 0x31DD, 0x30A2


def make_context():
    """Make a compatibility context without a surface current. Raises OSError saying which step failed."""
    egl = ctypes.CDLL("libEGL.so.1")
    egl.eglGetProcAddress.restype = egl.eglCreateContext.restype = ctypes.c_void_p
    address = egl.eglGetProcAddress(b"eglGetPlatformDisplayEXT")
    if not address:
        raise OSError("eglGetPlatformDisplayEXT is missing")
    signature = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)
    display = ctypes.c_void_p(signature(address)(_PLATFORM_SURFACELESS, None, None))
    if not egl.eglInitialize(display, None, None):
        raise OSError("eglInitialize failed")
    if not egl.eglBindAPI(ctypes.c_uint(_OPENGL_API)):
        raise OSError("eglBindAPI failed: this libEGL has no desktop OpenGL")
    # No configuration, since there is no surface (EGL_KHR_no_config_context); without a version and a profile
    # Mesa answers with a compatibility context.
    context = ctypes.c_void_p(egl.eglCreateContext(display, None, None, None))
    if not context or not egl.eglMakeCurrent(display, None, None, context):
        raise OSError("eglCreateContext or eglMakeCurrent failed")
