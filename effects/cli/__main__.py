"""``python -m fixedpipe.effects.cli``: the command line of a checkout, without installing it."""

from fixedpipe.effects.cli import main

main(prog_name="fixedpipe")
