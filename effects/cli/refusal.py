"""Refusals on the command line: a sentence on the error stream, and exit status 2. Ctrl-C gives 130."""

import signal
from contextlib import contextmanager

import click

from fixedpipe.effects.refusal import Refusal


class Said(click.ClickException):
    """A Refusal's sentence, with which the command line ends. ``before``: lines above it."""

    exit_code = 2

    def __init__(self, message, before=""):
        super().__init__(message)
        self.before = before

    def show(self, file=None):
        """Print the sentence."""
        click.echo(f"{self.before}fixedpipe: {self.format_message()}", file=file, err=True)


class Interrupted(click.ClickException):
    """Ctrl-C: the command line ends with a line, and with the exit status of this signal."""

    exit_code = 128 + signal.SIGINT

    def __init__(self):
        super().__init__("fixedpipe: interrupted.")

    def show(self, file=None):
        """Print the line."""
        click.echo(self.format_message(), file=file, err=True)


@contextmanager
def said():
    """Inside the block, a Refusal or a wrong command line becomes Said, so both print with the same prefix.
    Ctrl-C becomes Interrupted.
    """
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted from None
    except Refusal as error:
        raise Said(str(error)) from error
    except click.UsageError as error:
        context = error.ctx
        before = (
            f"{context.get_usage()}\nTry '{context.command_path} --help' for help.\n\n" if context else ""
        )
        raise Said(error.format_message(), before) from error


def check_size(what, dimensions, profile):
    """Raise Refusal if a picture of ``dimensions`` (width, height) is larger than the machine draws. The
    height is the value of --size.
    """
    largest, (width, size) = profile.framebuffers.max_viewport, dimensions
    if max(width, size) > largest:
        raise Refusal(
            f"{what} with --size {size} is {width}x{size} pixels; the {profile.name} draws up to "
            f"{largest}x{largest}. Give --size {largest * size // max(width, size)} or less."
        )
