"""How the command line says no: one sentence on the error stream and exit status 2."""

import difflib
from contextlib import contextmanager

import click


class Refusal(ValueError):  # noqa: N818 (it names what happens)
    """What was asked for cannot be done; the message is one sentence that says why and what to do."""


class Said(click.ClickException):
    """A Refusal's sentence as the command line ends with it."""

    exit_code = 2

    def show(self, file=None):
        """Print the sentence."""
        click.echo(f"fixedpipe: {self.format_message()}", file=file, err=True)


@contextmanager
def refusals():
    """Turn a ValueError, which carries a sentence, into a Refusal."""
    try:
        yield
    except ValueError as error:
        raise Refusal(str(error)) from error


def check_size(what, columns, size, profile):
    """Raise Refusal when a row of ``columns`` panels of ``size`` pixels is larger than the machine draws."""
    largest = profile.max_viewport
    if columns * size > largest:
        raise Refusal(
            f"{what} with --size {size} is {columns * size}x{size} pixels; the {profile.name} draws up to "
            f"{largest}x{largest}. Give --size {largest // columns} or less."
        )


def choose(what, name, known):
    """``known[name]``, or a Refusal that names what there is and what was probably meant."""
    if name in known:
        return known[name]
    as_written = {key.casefold(): key for key in known}
    close = [as_written[key] for key in difflib.get_close_matches(name.casefold(), as_written, 1, 0.6)]
    meant = f" Did you mean {close[0]}?" if close else ""
    raise Refusal(f"There is no {what} {name!r}.{meant} There are: {', '.join(known)}.")
