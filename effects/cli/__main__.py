"""``python -m fixedpipe.effects.cli``: the command line, by the interpreter that has it."""

from fixedpipe.effects.cli import main

main(prog_name="fixedpipe")
