"""Refusals on the command line: the sentence on the error stream, and exit status 2; 130 after Ctrl-C."""

import signal
from contextlib import contextmanager

import click

from fixedpipe.effects.refusal import Refusal


class Said(click.ClickException):
    """A Refusal's sentence as the command line ends with it; ``before``: lines above it."""

    exit_code = 2

    def __init__(self, message, before=""):
        super().__init__(message)
        self.before = before

    def show(self, file=None):
        """Print the sentence."""
        click.echo(f"{self.before}fixedpipe: {self.format_message()}", file=file, err=True)


class Interrupted(click.ClickException):
    """Ctrl-C, as the command line ends with it: a line, and the status of what the signal ends."""

    exit_code = 128 + signal.SIGINT

    def __init__(self):
        super().__init__("fixedpipe: interrupted.")

    def show(self, file=None):
        """Print the line."""
        click.echo(self.format_message(), file=file, err=True)


@contextmanager
def said():
    """What cannot be done, or was asked for in words that are none, ends as Said: with one prefix. Ctrl-C
    ends as Interrupted.
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
    """Raise Refusal when a picture of ``dimensions`` (width, height: its --size) is larger than the machine
    draws.
    """
    largest, (width, size) = profile.framebuffers.max_viewport, dimensions
    if max(width, size) > largest:
        raise Refusal(
            f"{what} with --size {size} is {width}x{size} pixels; the {profile.name} draws up to "
            f"{largest}x{largest}. Give --size {largest * size // max(width, size)} or less."
        )
