"""Rectangles of the window, where y points up, in device pixels, where y points down."""


def device_edges(box, height):
    """A window rectangle's left, top, right and bottom in device pixels."""
    x, y, across, up = int(box.x), int(box.y), int(box.width), int(box.height)
    return x, height - y - up, x + across, height - y


def scissored(box, width, height):
    """(x0, y0, x1, y1) in device pixels, half open: the window cut by a scissor box, or by None."""
    if box is None:
        return 0, 0, width, height
    left, top, right, bottom = device_edges(box, height)
    x0, x1 = max(left, 0), min(right, width)
    y0, y1 = max(top, 0), min(bottom, height)
    return x0, y0, max(x0, x1), max(y0, y1)


def scissored_part(box, width, height):
    """``scissored`` as slices of rows, counted from the top, and of columns."""
    left, top, right, bottom = scissored(box, width, height)
    return slice(top, bottom), slice(left, right)


def scissor_box(state, framebuffer):
    """``scissored`` of a state's scissor box."""
    return scissored(state.scissor, framebuffer.width, framebuffer.height)
