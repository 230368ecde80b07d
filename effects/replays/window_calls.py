"""The calls of GLX, WGL, EGL and CGL that make contexts and drawables, bind them or swap buffers.

Source: the GLX 1.4, WGL and EGL specifications, wingdi.h and Apple's CGLTypes.h: names and numbers.
"""

from collections.abc import Callable
from typing import Any

from fixedpipe.effects.replays.windows import Known, Window, WindowSystem, only

_EGL_NONE = 0x3038


def _pairs(attributes):
    """{name: value} of a list of pairs. A zero or EGL_NONE ends the list."""
    found = {}
    numbers = attributes if isinstance(attributes, list) else []
    for name, value in zip(numbers[::2], numbers[1::2], strict=False):
        if name in (0, _EGL_NONE):
            break
        found[name] = value
    return found


# --------------------------------------------------------------------------------------------------- GLX

_GLX_RGBA, _GLX_DOUBLEBUFFER, _GLX_COLOR_INDEX, _GLX_DONT_CARE = 4, 5, 0x8015, 0xFFFFFFFF
# Names in the list of glXChooseVisual that have no value: USE_GL, RGBA, DOUBLEBUFFER, STEREO.
_GLX_FLAGS = {1, 4, 5, 6}
_GLX_PBUFFER_HEIGHT, _GLX_PBUFFER_WIDTH = 0x8040, 0x8041


def _names(listed, has_value):
    """The names of a list that ends with a zero. ``has_value(name)``: whether a value follows the name."""
    names, at = set(), 0
    while at < len(listed or []) and listed[at]:
        names.add(listed[at])
        at += 2 if has_value(listed[at]) else 1
    return names


def _glx_choose_visual(system, call):
    names = _names(call.arguments[2], lambda name: name not in _GLX_FLAGS)
    system.say(call.result, Known(_GLX_DOUBLEBUFFER in names, _GLX_RGBA not in names))


def _glx_choose_config(system, call):
    said = _pairs(call.arguments[2]).get(_GLX_DOUBLEBUFFER)
    double = None if said in (None, _GLX_DONT_CARE, -1) else bool(said)
    for config in call.result or []:
        system.say(config, Known(double))


def _glx_visual_of_config(system, call):
    system.say(call.result, system.known(call.arguments[1]))


def _glx_config_attribute(system, call):
    _, config, name, value = call.arguments[:4]
    if name == _GLX_DOUBLEBUFFER and value:
        system.say(config, system.known(config)._replace(double=bool(value[0])))


def _glx_create_context(system, call):
    _, visual, share = call.arguments[:3]
    system.make_context(call.result, visual, share)


def _glx_create_new_context(system, call):
    _, config, kind, share = call.arguments[:4]
    system.make_context(call.result, config, share, kind == _GLX_COLOR_INDEX)


def _glx_create_context_attributes(system, call):
    _, config, share = call.arguments[:3]
    system.make_context(call.result, config, share)


def _glx_create_window(system, call):
    system.say(call.result, system.known(call.arguments[1]))


def _glx_create_pbuffer(system, call):
    said = _pairs(call.arguments[2])
    width, height = said.get(_GLX_PBUFFER_WIDTH, 1), said.get(_GLX_PBUFFER_HEIGHT, 1)
    system.make_pbuffer(call.result, call.arguments[1], width, height)


def _glx_create_pbuffer_sgix(system, call):
    _, config, width, height = call.arguments[:4]
    system.make_pbuffer(call.result, config, width, height)


def _glx_make_current(system, call):
    _, drawable, context = call.arguments[:3]
    system.make_current(call, drawable, context)


def _make_current_of_two(system, call):
    """Bind a drawable for drawing and one for reading, in GLX and EGL."""
    _, draw, read, context = call.arguments[:4]
    if context and read != draw:
        system.tally.add("refused", f"{call.name}: reading from another drawable than is drawn into")
    system.make_current(call, draw, context)


def _second_destroyed(system, call):
    return system.destroy_context(call.arguments[1])


def _second_forgotten(system, call):
    system.forget_drawable(call.arguments[1])


def _swap_second(system, call):
    return _swapped(system.window_of(call.arguments[1]))


def _swapped(window):
    """The window whose buffers a call swaps; None if it has only one buffer, so that nothing happens."""
    if window is None or window.double is False:
        return None
    window.double, window.unbound = True, False
    return window


def _refuse(reason):
    def refuse(system, call):
        system.tally.add("refused", f"{call.name}: {reason}")

    return refuse


def _copy_context(system, call):
    if call.result == 0 and call.result is not None:
        return  # the call failed
    source, target, mask = call.arguments[-3:]
    if reason := system.copy(source, target, mask):
        system.tally.add("error", f"{call.name}: {reason}")


# --------------------------------------------------------------------------------------------------- WGL

_PFD_DOUBLEBUFFER, _PFD_DOUBLEBUFFER_DONTCARE, _PFD_COLOR_INDEX, _WGL_DOUBLE_BUFFER = 1, 1 << 30, 1, 0x2011


def _described(descriptor):
    """The Known properties of a PIXELFORMATDESCRIPTOR; None if the value is no such structure."""
    descriptor = only(descriptor)
    if not isinstance(descriptor, dict) or "dwFlags" not in descriptor:
        return None
    indexed = descriptor.get("iPixelType") == _PFD_COLOR_INDEX
    flags = descriptor["dwFlags"]
    says = flags and not flags & _PFD_DOUBLEBUFFER_DONTCARE  # programs leave a descriptor empty, too
    return Known(bool(flags & _PFD_DOUBLEBUFFER) if says else None, indexed)


def _wgl_choose_format(system, call):
    known = _described(call.arguments[1])
    if known is not None and call.result:
        system.say(("format", call.result), known)


def _wgl_choose_formats(system, call):
    said = _pairs(call.arguments[1]).get(_WGL_DOUBLE_BUFFER)
    for chosen in call.arguments[4] or []:
        system.say(("format", chosen), Known(None if said is None else bool(said)))


def _wgl_describe_format(system, call):
    known = _described(call.arguments[3])
    if known is not None and call.result:
        system.say(("format", call.arguments[1]), known)


def _wgl_set_format(system, call):
    # The number decides. The descriptor beside it changes nothing.
    device, chosen, descriptor = call.arguments[:3]
    known = system.known(("format", chosen))
    system.say(device, known if known.double is not None else _described(descriptor) or known)


def _wgl_create_context(system, call):
    system.make_context(call.result, call.arguments[0], None)


def _wgl_create_context_attributes(system, call):
    device, share = call.arguments[:2]
    system.make_context(call.result, device, share)


def _wgl_make_current(system, call):
    device, context = call.arguments[:2]
    system.make_current(call, device, context)


def _wgl_make_current_of_two(system, call):
    draw, read, context = call.arguments[:3]
    if context and read != draw:
        system.tally.add("refused", f"{call.name}: reading from another drawable than is drawn into")
    system.make_current(call, draw, context)


def _wgl_share(system, call):
    if call.result != 0:
        system.share(*call.arguments[:2])


def _wgl_create_pbuffer(system, call):
    _, chosen, width, height = call.arguments[:4]
    system.make_pbuffer(call.result, ("format", chosen), width, height)


def _wgl_device_of_pbuffer(system, call):
    system.alias(call.result, call.arguments[0])


def _first_destroyed(system, call):
    return system.destroy_context(call.arguments[0])


def _cgl_destroyed(system, call):
    """Destroy a context of CGL, which is its own drawable: another may be made at its address."""
    window = system.destroy_context(call.arguments[0])
    system.forget_drawable(("context", call.arguments[0]))
    return window


def _first_forgotten(system, call):
    system.forget_drawable(call.arguments[0])


def _swap_first(system, call):
    # A window may have several device contexts. Assumed: one that was never current is of the current window.
    window = system.window_of(call.arguments[0]) or system.current_window(call.thread)
    return _swapped(window)


# --------------------------------------------------------------------------------------------------- EGL

_EGL_HEIGHT, _EGL_WIDTH, _EGL_RENDER_BUFFER, _EGL_SINGLE = 0x3056, 0x3057, 0x3086, 0x3085


def _egl_create_context(system, call):
    _, config, share = call.arguments[:3]
    system.make_context(call.result, config, share)


def _egl_create_window(system, call):
    said = _pairs(call.arguments[3])
    system.say(call.result, Known(said.get(_EGL_RENDER_BUFFER) != _EGL_SINGLE))


def _egl_create_pbuffer(system, call):
    said = _pairs(call.arguments[2])
    system.make_pbuffer(call.result, None, said.get(_EGL_WIDTH, 1), said.get(_EGL_HEIGHT, 1))
    system.say(call.result, Known(False))  # EGL's pbuffers are single-buffered


# --------------------------------------------------------------------------------------------------- CGL

_CGL_DOUBLE_BUFFER = 5
# Names in the list of CGLChoosePixelFormat that have a value. Source: Apple's CGLTypes.h.
_CGL_VALUED = {7, 8, 11, 12, 13, 14, 50, 55, 56, 60, 70, 77, 84, 99, 128, 132}


def _cgl_choose_format(system, call):
    names = _names(call.arguments[0], _CGL_VALUED.__contains__)
    system.say(only(call.arguments[1]), Known(_CGL_DOUBLE_BUFFER in names))


def _cgl_create_context(system, call):
    chosen, share, made = call.arguments[:3]
    system.make_context(only(made), chosen, share)


def _cgl_make_current(system, call):
    context = call.arguments[0]  # the call's result is the number of an error, or 0
    system.make_current(call._replace(result=None), ("context", context), context)


def _cgl_copy_context(system, call):
    if not call.result:  # the number of an error, or 0
        _copy_context(system, call._replace(result=None))


def _cgl_flush(system, call):
    return _swapped(system.window_of_context(call.arguments[0]))


_NO_FONTS = "the trace has no bitmaps of the system's fonts"

_HANDLERS: dict[str, Callable[[WindowSystem, Any], Window | None]] = {
    "glXChooseVisual": _glx_choose_visual,
    "glXChooseFBConfig": _glx_choose_config,
    "glXChooseFBConfigSGIX": _glx_choose_config,
    "glXGetVisualFromFBConfig": _glx_visual_of_config,
    "glXGetFBConfigAttrib": _glx_config_attribute,
    "glXGetConfig": _glx_config_attribute,
    "glXCreateContext": _glx_create_context,
    "glXCreateNewContext": _glx_create_new_context,
    "glXCreateContextWithConfigSGIX": _glx_create_new_context,
    "glXCreateContextAttribsARB": _glx_create_context_attributes,
    "glXCreateWindow": _glx_create_window,
    "glXCreatePbuffer": _glx_create_pbuffer,
    "glXCreateGLXPbufferSGIX": _glx_create_pbuffer_sgix,
    "glXMakeCurrent": _glx_make_current,
    "glXMakeContextCurrent": _make_current_of_two,
    "glXMakeCurrentReadSGI": _make_current_of_two,
    "glXDestroyContext": _second_destroyed,
    "glXFreeContextEXT": _second_destroyed,
    "glXDestroyWindow": _second_forgotten,
    "glXDestroyPbuffer": _second_forgotten,
    "glXDestroyGLXPbufferSGIX": _second_forgotten,
    "glXSwapBuffers": _swap_second,
    "glXSwapBuffersMscOML": _swap_second,
    "glXUseXFont": _refuse(_NO_FONTS),
    "glXCopyContext": _copy_context,
    "glXBindTexImageEXT": _refuse("a pixmap or pbuffer of the window system as a texture"),
    "ChoosePixelFormat": _wgl_choose_format,
    "wglChoosePixelFormat": _wgl_choose_format,
    "wglChoosePixelFormatARB": _wgl_choose_formats,
    "wglChoosePixelFormatEXT": _wgl_choose_formats,
    "SetPixelFormat": _wgl_set_format,
    "wglSetPixelFormat": _wgl_set_format,
    "wglCreateContext": _wgl_create_context,
    "wglCreateLayerContext": _wgl_create_context,
    "wglCreateContextAttribsARB": _wgl_create_context_attributes,
    "wglMakeCurrent": _wgl_make_current,
    "wglMakeContextCurrentARB": _wgl_make_current_of_two,
    "wglMakeContextCurrentEXT": _wgl_make_current_of_two,
    "wglShareLists": _wgl_share,
    "wglDeleteContext": _first_destroyed,
    "wglCreatePbufferARB": _wgl_create_pbuffer,
    "wglCreatePbufferEXT": _wgl_create_pbuffer,
    "wglGetPbufferDCARB": _wgl_device_of_pbuffer,
    "wglGetPbufferDCEXT": _wgl_device_of_pbuffer,
    "wglDestroyPbufferARB": _first_forgotten,
    "wglDestroyPbufferEXT": _first_forgotten,
    "SwapBuffers": _swap_first,
    "wglSwapBuffers": _swap_first,
    "wglSwapLayerBuffers": _swap_first,
    "wglUseFontBitmapsA": _refuse(_NO_FONTS),
    "wglUseFontBitmapsW": _refuse(_NO_FONTS),
    "wglUseFontOutlinesA": _refuse(_NO_FONTS),
    "wglUseFontOutlinesW": _refuse(_NO_FONTS),
    "wglCopyContext": _copy_context,
    "wglDescribePixelFormat": _wgl_describe_format,
    "DescribePixelFormat": _wgl_describe_format,
    "wglBindTexImageARB": _refuse("a pbuffer of the window system as a texture"),
    "eglCreateContext": _egl_create_context,
    "eglCreateWindowSurface": _egl_create_window,
    "eglCreatePlatformWindowSurface": _egl_create_window,
    "eglCreatePlatformWindowSurfaceEXT": _egl_create_window,
    "eglCreatePbufferSurface": _egl_create_pbuffer,
    "eglMakeCurrent": _make_current_of_two,
    "eglSwapBuffers": _swap_second,
    "eglSwapBuffersWithDamageKHR": _swap_second,
    "eglSwapBuffersWithDamageEXT": _swap_second,
    "eglDestroyContext": _second_destroyed,
    "eglDestroySurface": _second_forgotten,
    "CGLChoosePixelFormat": _cgl_choose_format,
    "CGLCreateContext": _cgl_create_context,
    "CGLSetCurrentContext": _cgl_make_current,
    "CGLDestroyContext": _cgl_destroyed,
    "CGLCopyContext": _cgl_copy_context,
    "CGLTexImagePBuffer": _refuse("a pbuffer of the window system as a texture"),
    "CGLReleaseContext": _first_destroyed,
    "CGLFlushDrawable": _cgl_flush,
}
# Calls that end a context. They end a frame of its window only if something was drawn.
DESTROYING = {name for name, handler in _HANDLERS.items() if handler in (_first_destroyed, _second_destroyed)}
_PREFIXES = ("glX", "wgl", "egl", "CGL")
_OTHERS = {"ChoosePixelFormat", "SetPixelFormat", "SwapBuffers", "DescribePixelFormat", "GetPixelFormat"}


def is_window_call(name: str) -> bool:
    """Whether a function belongs to the window system, and not to OpenGL."""
    return name.startswith(_PREFIXES) or name in _OTHERS


def take_window_call(system: WindowSystem, call: Any) -> Window | None:
    """Carry out a call of the window system. Returns the drawable whose frame it ends, or None."""
    handler = _HANDLERS.get(call.name)
    if handler is None:
        system.tally.add("no effect", call.name)
        return None
    try:
        return handler(system, call)
    except (TypeError, ValueError, IndexError, KeyError, AttributeError, OverflowError) as error:
        # A damaged trace may have other values in place of a call's arguments.
        system.tally.add("refused", f"{call.name}: its arguments cannot be read ({type(error).__name__})")
        return None
