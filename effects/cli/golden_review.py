"""The review of pictures that are not golden, in the terminal. It shows each, and the user presses a key."""

import click
import numpy as np

# The most columns and rows that a picture takes. A row is half a character high.
_COLUMNS, _ROWS = 36, 40
_KEYS = "a accept   s later   d pixels   q end"


def review_by_keys(root, found):
    """Let the user decide on every picture that differs or is new. ``found``: what ``results`` returns.
    Raises StoreError.
    """
    from fixedpipe.effects.reports.golden.results import CHANGED, NEW
    from fixedpipe.pipeline.golden.accepting import accept_where_sound
    from fixedpipe.pipeline.golden.candidates import read_candidates

    candidates = read_candidates(root)
    waiting = [e for e in found if e["status"] in (CHANGED, NEW) and e["name"] in candidates]
    others = [e for e in found if e["status"] in ("missing", "orphan")]
    for entry in others:
        click.echo(f"{entry['status']}: {entry['name']}")
    if not waiting:
        click.echo("No picture waits to be accepted.")
        return
    accepted = 0
    for number, entry in enumerate(waiting, 1):
        candidate = candidates[entry["name"]]
        click.echo(f"\n{number} of {len(waiting)}  {entry['status']}  {entry['name']}\n{entry['told']}")
        _draw(root, candidate)
        while True:
            click.echo(f"{_KEYS}: ", nl=False)
            key = _key()
            click.echo(key if key.isprintable() else "")
            if key == "a":
                for sentence in accept_where_sound(root, [candidate]):
                    click.echo(sentence)
                accepted += 1
                break
            if key == "q":
                click.echo(f"{accepted} accepted, {len(waiting) - number + 1} left.")
                return
            if key == "d":
                _pixels(root, candidate)
            elif key == "s":
                break
    click.echo(f"{accepted} accepted.")


def _key():
    """The key that the user pressed; "q" for Ctrl-C and Ctrl-D. Raises Refusal if there is no keyboard."""
    from fixedpipe.effects.refusal import Refusal

    try:
        return click.getchar(echo=False).lower()
    except (KeyboardInterrupt, EOFError):
        return "q"
    except OSError as error:
        raise Refusal(
            "The review needs a terminal with a keyboard, and there is none here. Write the page instead, "
            "with --html FILE, and accept by `fixedpipe golden accept NAME`."
        ) from error


def _shown(pixels):
    """RGB bytes of a picture. A larger picture is reduced, by nearest pixels, until it fits."""
    step = max(1, -(-pixels.shape[1] // _COLUMNS), -(-pixels.shape[0] // _ROWS))
    small = pixels[step // 2 :: step, step // 2 :: step]
    small = (small >> 8).astype(np.uint8) if small.dtype == np.uint16 else small
    return np.repeat(small[..., :1], 3, axis=2) if small.shape[2] < 3 else small[..., :3]


def _draw(root, candidate):
    """Print the golden picture, the new one, and where they differ, as half blocks of colour. A terminal
    without colours shows nothing.
    """
    from rich.console import Console
    from rich.text import Text

    from fixedpipe.pipeline.golden.candidates import candidate_pixels

    console = Console(highlight=False)
    if not console.is_terminal or console.color_system not in ("256", "truecolor"):
        return
    now, expected = candidate_pixels(root, candidate), _golden(root, candidate)
    pictures = [("now", _shown(now))]
    if expected is not None:
        pictures.insert(0, ("golden", _shown(expected)))
        if expected.shape == now.shape and expected.dtype == now.dtype:
            apart = (expected != now).any(axis=2)
            mask = np.where(apart, 255, 24).astype(np.uint8)
            pictures.append(("where", _shown(_spread(mask))))
    width = max(picture.shape[1] for _, picture in pictures)
    console.print("".join(f"{title:{width + 2}}" for title, _ in pictures), markup=False)
    for row in range(0, max(picture.shape[0] for _, picture in pictures), 2):
        line = Text()
        for _, picture in pictures:
            for column in range(width + 2):
                inside = column < picture.shape[1] and row < picture.shape[0]
                if not inside:
                    line.append(" ")
                    continue
                upper = picture[row, column]
                lower = picture[min(row + 1, picture.shape[0] - 1), column]
                line.append("▀", style=f"{_hex(upper)} on {_hex(lower)}")
        console.print(line)


def _golden(root, candidate):
    """The golden pixels; None if no file holds them. The picture's sentences say so then."""
    from fixedpipe.pipeline.golden.candidates import golden_pixels
    from fixedpipe.pipeline.golden.store import StoreError

    try:
        return golden_pixels(root, candidate)
    except StoreError:
        return None


def _spread(mask):
    """A mask [h, w, 1] for a reduced picture: a pixel is set if any of the pixels that it replaces is set."""
    step = max(1, -(-mask.shape[1] // _COLUMNS), -(-mask.shape[0] // _ROWS))
    out = mask.copy()
    for y in range(0, mask.shape[0], step):
        for x in range(0, mask.shape[1], step):
            out[y : y + step, x : x + step] = mask[y : y + step, x : x + step].max()
    return out[..., None]


def _hex(color):
    return "#" + "".join(f"{int(component):02x}" for component in color)


def _pixels(root, candidate):
    """The first pixels that differ, as codes."""
    from fixedpipe.pipeline.golden.candidates import candidate_pixels

    now, expected = candidate_pixels(root, candidate), _golden(root, candidate)
    if expected is None or expected.shape != now.shape or expected.dtype != now.dtype:
        click.echo("There are no two pictures of one kind to compare.")
        return
    places = np.argwhere((expected != now).any(axis=2))
    for y, x in places[:10].tolist():
        click.echo(f"  ({x}, {y}): {tuple(expected[y, x].tolist())}, now {tuple(now[y, x].tolist())}")
    if len(places) > 10:
        click.echo(f"  and {len(places) - 10} more")
