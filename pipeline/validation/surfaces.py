"""Validation of the window and of pbuffers: their sizes, formats and rectangles."""

from fixedpipe.pipeline.commands import box_read
from fixedpipe.pipeline.enums import DepthFormat
from fixedpipe.pipeline.messages import count, depth_words, listed, quoted, shown, surface_words
from fixedpipe.pipeline.validation.types import check_int
from fixedpipe.pipeline.validation.walk import KnownSurface, UnsupportedState


def check_framebuffer(profile, width, height, depth_bits, what="The framebuffer"):
    """Refuse a framebuffer of a size or a depth format that the machine lacks. Raises UnsupportedState."""
    for name, number in (("width", width), ("height", height), ("depth_bits", depth_bits)):
        if wrong := check_int(number):
            raise UnsupportedState(f"{what}'s {name} {wrong.predicate}.")
    if width < 1 or height < 1:
        raise UnsupportedState(f"{what} is {width}x{height}; give at least 1x1.")
    # Source: OpenGL 1.2.1 section 2.10.1: the largest viewport covers every displayable pixel.
    if max(width, height) > profile.framebuffers.max_viewport:
        raise UnsupportedState(
            f"{what} is {width}x{height}; {profile.name} draws up to "
            f"{profile.framebuffers.max_viewport}x{profile.framebuffers.max_viewport}. Draw it in tiles."
        )
    if depth_bits not in profile.framebuffers.depth_bits:
        formats = " or ".join(
            f.name if f.is_float else str(f.bits) for f in map(DepthFormat, profile.framebuffers.depth_bits)
        )
        raise UnsupportedState(
            f"{what} has {depth_words(depth_bits)}; {profile.name} has {formats}. Give one of these."
        )


def check_samples(profile, samples):
    """Refuse a number of samples that the machine lacks. Raises UnsupportedState."""
    if wrong := check_int(samples):
        raise UnsupportedState(f"The framebuffer's samples {wrong.predicate}.")
    if samples not in profile.framebuffers.samples:
        allowed = " or ".join(map(str, profile.framebuffers.samples))
        raise UnsupportedState(
            f"The framebuffer has {count(samples, 'sample')} in each pixel; {profile.name} has {allowed}. "
            "Give one of these, or draw the scene several times, shifted, and accumulate."
        )


def check_color_bits(profile, color_bits):
    """Refuse a width of colour components that the machine lacks. Raises UnsupportedState."""
    if wrong := check_int(color_bits):
        raise UnsupportedState(f"The framebuffer's color_bits {wrong.predicate}.")
    if color_bits not in profile.framebuffers.color_bits:
        widths = " or ".join(map(str, profile.framebuffers.color_bits))
        raise UnsupportedState(
            f"The framebuffer's colors have {shown(color_bits)} bits a component; {profile.name} has "
            f"{widths}. Give one of these, or change the machine by with_precision."
        )


def make_current(walk, command):
    """Refuse a pbuffer that the machine could not make. Later commands draw to it, or to the window."""
    name = command.surface
    if name is None:
        if command.width is not None or command.height is not None:
            walk.refuse("the window has its size; give width and height to pbuffers only.")
        if command.shares_depth or command.depth_of is not None:
            walk.refuse("the window has its own depths; let the pbuffer share them.")
        walk.width, walk.height, _, walk.depth_bits = walk.window[:4]
        walk.in_window = True
        return
    if not walk.profile.framebuffers.surface_formats:
        walk.refuse(f"{walk.profile.name} has no pbuffers; draw to the window and use CopyTexImage.")
    if command.color_format not in walk.profile.framebuffers.surface_formats:
        walk.refuse(
            f"{walk.profile.name} has no surface format {command.color_format.name}; it has "
            f"{listed(walk.profile.framebuffers.surface_formats)}."
        )
    if command.width is None or command.height is None:
        walk.refuse(f"pbuffer {name!r} has no width or no height; give both.")
    if wrong := check_int(command.samples):
        walk.refuse(f"the pbuffer's samples {wrong.predicate}.")
    if command.samples not in walk.profile.framebuffers.samples:
        allowed = " or ".join(map(str, walk.profile.framebuffers.samples))
        walk.refuse(
            f"pbuffer {name!r} has {count(command.samples, 'sample')} in each pixel; "
            f"{walk.profile.name} has {allowed}. Give one of these."
        )
    asked = KnownSurface(*(getattr(command, name) for name in KnownSurface._fields))
    _shared_depth(walk, command)
    made = walk.surfaces.setdefault(name, asked)
    if made != asked:
        walk.refuse(
            f"pbuffer {name!r} is {made} since it was made, and this asks for {asked}; give the same, "
            "or another name."
        )
    check_framebuffer(
        walk.profile, command.width, command.height, command.depth_bits, walk.where + ": the pbuffer"
    )
    walk.width, walk.height, walk.depth_bits = command.width, command.height, command.depth_bits
    walk.in_window = False


def _shared_depth(walk, command):
    """Refuse a pbuffer that cannot share the depth buffer it names."""
    name, of = command.surface, command.depth_of
    if not command.shares_depth:
        if of is not None:
            walk.refuse(
                f"pbuffer {name!r} names the depths of {of!r} and shares none; set shares_depth, or leave "
                "depth_of out."
            )
        return
    if not walk.profile.framebuffers.shared_depth:
        walk.refuse(
            f"every pbuffer of {walk.profile.name} has its own depths; leave shares_depth False, and draw "
            "them again."
        )
    owner = walk.window if of is None else walk.surfaces.get(of)
    if owner is None or of == name:
        made = quoted([known for known in walk.surfaces if known != name])
        walk.refuse(
            f"pbuffer {name!r} shares the depths of {of!r}, and there is no such pbuffer yet (made so far: "
            f"{made}); name one of these, or None for the window."
        )
    if owner.shares_depth:
        walk.refuse(
            f"pbuffer {name!r} shares the depths of {of!r}, whose depths are those of "
            f"{surface_words(owner.depth_of)}; name that."
        )
    if command.width > owner.width or command.height > owner.height:
        walk.refuse(
            f"pbuffer {name!r} is {command.width}x{command.height}, and {surface_words(of)}, whose depths it "
            f"shares, {owner.width}x{owner.height}; give at most that."
        )
    for what, own, others in (
        ("depth_bits", int(command.depth_bits), int(owner.depth_bits)),
        ("samples", command.samples, owner.samples),
    ):
        if own != others:
            walk.refuse(
                f"pbuffer {name!r} has {what} {own}, and {surface_words(of)}, whose depths it shares, "
                f"{others}; give that."
            )


def inside(walk, what, rectangle, width, height):
    """Refuse a rectangle (x, y, width, height) that reaches outside ``what``.

    ``what`` has ``width`` x ``height`` pixels.
    """
    x, y, w, h = rectangle
    if w < 0 or h < 0:
        walk.refuse(f"the rectangle is {w}x{h}; give sizes that are not negative.")
    if x < 0 or y < 0 or x + w > width or y + h > height:
        walk.refuse(
            f"the rectangle {w}x{h} at ({x}, {y}) reaches outside {what}, which is {width}x{height}; "
            "move it inside."
        )


def framebuffer_rectangle(walk, command):
    """Width and height of the framebuffer rectangle that a command reads; refuse one that reaches outside."""
    box = box_read(command, walk.width, walk.height)
    inside(walk, "the framebuffer", box, walk.width, walk.height)
    return box[2:]


def scissor(walk, scissor):
    """Refuse a scissor box, or a rectangle of a window clip, of negative size."""
    if scissor.width < 0 or scissor.height < 0:
        walk.refuse(f"the scissor box is {scissor.width}x{scissor.height}; give sizes that are not negative.")
