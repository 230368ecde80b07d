"""Parts of pages that show pictures of a machine, in a browser: views that are flipped, wiped, paired and
subtracted at one place, a loupe, numbers in pixels, a strip of crops, labels, and PNG files.

The modules know no page. ``stage.js`` says what it needs to know of the pictures: a *model*. They are plain
scripts without imports, in the order of SCRIPTS, because a page that was opened from a file may not import
modules. A page puts them, and its own after them, into one script element: ``script``. Names are then seen by
all that follow.
"""

from importlib.resources import files

# In the order in which they use each other.
SCRIPTS = ("elements", "codes", "digits", "png", "labels", "layout", "stage", "loupe", "strip")


def script(package, names):
    """The shared modules and then those of a page, as one script: text.

    package  the page's package, "fixedpipe.effects.reports.gallery" for instance
    names    of its modules, without .js, in the order in which they use each other
    """
    shared = (_text(__package__, f"{name}.js") for name in SCRIPTS)
    own = (_text(package, f"{name}.js") for name in names)
    return f'(() => {{\n"use strict";\n{"".join(shared)}{"".join(own)}}})();'


def style(package, name):
    """The style of the shared parts and then that of a page, as one text."""
    return _text(__package__, "viewing.css") + _text(package, name)


def _text(package, name):
    return (files(package) / name).read_text(encoding="utf-8")
