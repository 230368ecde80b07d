"""A folder of captures: SUITE/CASE.png, found, checked before anything is drawn, and read."""

from functools import partial

from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.refusal import Refusal, choose


def _entries(folder):
    try:
        return sorted(folder.iterdir())
    except OSError as error:
        raise Refusal(f"The folder {folder} cannot be read: {error.strerror}.") from error


def _check(path):
    """Raise Refusal for a file that is no whole capture: its size, and the checksums of all its parts."""
    from PIL import Image

    try:
        with Image.open(path, formats=("PNG",)) as image:
            size = image.size
            image.verify()
    # A decoder fed arbitrary bytes raises whatever it stumbles over.
    except Exception as error:
        reason = getattr(error, "strerror", None) or "it is no whole PNG file"
        raise Refusal(f"{path} cannot be read: {reason}. Fetch the captures again.") from error
    if size != (WIDTH, HEIGHT):
        raise Refusal(f"{path} has {size[0]}x{size[1]} pixels; a capture has {WIDTH}x{HEIGHT}.")


def read(path):
    """A capture's pixels, uint8 [HEIGHT, WIDTH, 4]. Raises Refusal."""
    import numpy as np
    from PIL import Image

    try:
        with Image.open(path, formats=("PNG",)) as image:
            return np.array(image.convert("RGBA"))
    except Exception as error:
        raise Refusal(
            f"{path} cannot be read; was it changed meanwhile? Fetch the captures again."
        ) from error


def find_captures(folder, suites=(), text=""):
    """The captures in a folder, by suite and name: a list of ``fixedpipe.effects.conformance.run.Capture``.

    ``suites``: only these (empty: all). ``text``: only names that contain it. Raises Refusal where there are
    none, or where one of them is no whole picture of the right size.
    """
    from fixedpipe.effects.conformance.run import Capture

    found = [
        (suite.name, path)
        for suite in _entries(folder)
        if suite.is_dir()
        for path in _entries(suite)
        if path.suffix == ".png"
    ]
    if not found:
        raise Refusal(
            f"{folder} holds no captures (SUITE/CASE.png); give the folder `results` of the captures."
        )
    for suite in suites:
        choose("suite", suite, dict(found))
    chosen = [(s, path) for s, path in found if (not suites or s in suites) and text in path.stem]
    if not chosen:
        raise Refusal(f"No case in {folder} has a name with {text!r} in it.")
    for _, path in chosen:
        _check(path)
    return [Capture(suite, path.stem, partial(read, path), path) for suite, path in chosen]
