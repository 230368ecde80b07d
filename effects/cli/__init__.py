"""``fixedpipe``: one subcommand per file. A file is imported only on use, so ``--help`` is quick."""

import gc
import importlib
import warnings
from contextlib import contextmanager

import click

from fixedpipe.effects.cli.compiling import COMPILING
from fixedpipe.effects.cli.refusal import said

_COMMANDS = (
    "figures",
    "passes",
    "parameters",
    "view",
    "print",
    "inspect",
    "pixel",
    "compare",
    "animate",
    "sweep",
    "replay",
    "nv2a",
    "bump",
    "roughness",
    "material",
    "shadows",
    "volume",
    "brdf",
    "scatter",
    "environment",
    "combiners",
    "precision",
    "study",
    "profiles",
    "conformance",
    "selftest",
    "golden",
    "warmup",
    "cache",
)

_WELCOME = """\
fixedpipe emulates the graphics hardware of 1997-2001, bit for bit.

What to do next:
  fixedpipe figures             draw every figure into ./out, with a gallery: out/index.html
  fixedpipe figures --list      print which figures there are
  fixedpipe view F004-4         show a figure live in your browser: move its light and camera, change machine
  fixedpipe passes F004-4       print how a figure is made, pass by pass
  fixedpipe inspect F004-4 --pixel 300,200
                                print every register of a pixel, and where it differs from the ideal
  fixedpipe pixel STATE.json    print the pixel that a machine draws of a small state, for your own test
  fixedpipe compare F004-4 --machines GEFORCE_256 FUTURE
                                find where two machines' pictures diverge: command, pixel, stage
  fixedpipe parameters F004-4   print what you can change; fixedpipe figures F004-4 --set alpha_x=0.15
  fixedpipe print F003-21       put a figure on a page: machine, reference, difference, labels and caption
  fixedpipe animate F004-4      animate a figure's light, camera or bits, without losses
  fixedpipe sweep F004-8 --vary bits=4:16 --out bits.csv
                                compute a figure over a grid of values, as a table, on many computers
  fixedpipe replay GAME.trace   draw what a recorded OpenGL program drew, on the machine it was written for
  fixedpipe nv2a FRAME.nv2a     draw an emulator's log of the NV2A's registers and vertices
  fixedpipe bump sample:gravel --mesh torus --material gold --light 1,2,3 --out gravel.png
                                bump-map a mesh with a photograph
  fixedpipe roughness sample:gravel --out gravel.npz --picture gravel.png
                                compute a bump map's levels, and the roughness that filtering removes
  fixedpipe material ward --mesh teapot --color 1,0.8,0.38 --environment room --out gold.png
                                draw a mesh with any reflectance: a model, a MERL table, a simulated one
  fixedpipe shadows MESH.obj --algorithm z-fail --out shadows.png
                                draw a mesh's shadow by an algorithm of the time, and compare it with rays
  fixedpipe volume sample:engine --out engine.png
                                draw an iso-surface of a volume, with shadows
  fixedpipe brdf sample:gravel --out gravel.binary --picture gravel.png
                                compute the BRDF of a height field, with light scattered between its bumps
  fixedpipe scatter sample:gravel --out scattered.png
                                draw the light that bumps scatter onto each other, by a machine's own passes
  fixedpipe environment PANORAMA.hdr --to prefilter --exponent 100 --out glossy.png
                                make cube, parabolic or filtered maps of a panorama or light probe
  fixedpipe combiners FILE      print a combiner program of the time (RC1.0, TS1.0, ps.1.x) as equations
  fixedpipe precision F004-4    separate the error of clamps from the error of short numbers
  fixedpipe study               list the studies of artefacts; fixedpipe study P9 measures one
  fixedpipe profiles            list the machines; fixedpipe profiles NAME says how each value is known
  fixedpipe golden review       look at pictures that your tests drew and nobody has accepted, and accept them
  fixedpipe conformance DIR     redraw captures of a real NV2A, and count equal pixels
  fixedpipe selftest            check that this computer draws the accepted bits with every engine
  fixedpipe warmup              compile all kernels now, so that nothing waits for them later
  fixedpipe cache               print where the kernels are kept; fixedpipe cache clear removes them
  fixedpipe --help              print all commands and options"""


# Warnings about drawings, and about compiled kernels that could not be stored.
_SAID = ("DisabledTexture", "StoredAlpha", "KernelsNotKept")


def _say(otherwise):
    """A function that shows warnings: those of _SAID once, as a sentence; ``otherwise`` shows the others."""
    said = set()

    def show(message, category, *where, **more):
        if category.__name__ not in _SAID:  # by name, because their modules load an array library
            otherwise(message, category, *where, **more)
        elif (sentence := str(message)) not in said:
            said.add(sentence)
            click.echo(f"fixedpipe: {sentence}", err=True)

    return show


@contextmanager
def _reading_said():
    """While the block runs, print a line for each file that says what it was read as."""
    from logging import INFO, Handler, getLogger

    said = set()

    class Shown(Handler):
        def emit(self, record):
            if (line := record.getMessage()) not in said:
                said.add(line)
                click.echo(line, err=True)

    log, shown = getLogger("fixedpipe.reading"), Shown()
    level = log.level
    log.addHandler(shown)
    log.setLevel(INFO)
    try:
        yield
    finally:
        log.removeHandler(shown)
        log.setLevel(level)


class LazyGroup(click.Group):
    """A group that imports a subcommand's module when the subcommand is looked up."""

    def list_commands(self, ctx):
        """The subcommands in the order in which a newcomer needs them."""
        return list(_COMMANDS)

    def get_command(self, ctx, cmd_name):
        """The subcommand of that name, or None."""
        if cmd_name not in _COMMANDS:
            return None
        return getattr(importlib.import_module(f"fixedpipe.effects.cli.{cmd_name}"), cmd_name)

    def resolve_command(self, ctx, args):
        """The subcommand that the user named. For an unknown name, a Refusal suggests a similar one."""
        from fixedpipe.effects.refusal import choose

        choose("command", args[0], dict.fromkeys(_COMMANDS))
        return super().resolve_command(ctx, args)

    def make_context(self, *arguments, **settings):
        """The group's context. Errors in the command line are printed in the same form as Refusals."""
        with said():
            return super().make_context(*arguments, **settings)

    def invoke(self, ctx):
        """Run the subcommand. A Refusal or a wrong option prints a sentence and gives exit status 2. A
        warning prints a sentence.
        """
        ctx.with_resource(warnings.catch_warnings())
        warnings.showwarning = _say(warnings.showwarning)
        ctx.with_resource(_reading_said())
        with said():
            result = super().invoke(ctx)
            if wait := ctx.meta.get(COMPILING):
                wait()
            return result


@click.group(
    cls=LazyGroup, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(package_name="fixedpipe", message="%(prog)s %(version)s")
@click.pass_context
def main(context):
    """The graphics hardware of 1997-2001, emulated bit for bit: figures of papers, pictures of your own."""
    # Imports make some hundred thousand objects that stay. If the garbage collector looked at them again and
    # again, it would take a twentieth of a figure's time.
    gc.set_threshold(100_000)
    if context.invoked_subcommand is None:
        click.echo(_WELCOME)
