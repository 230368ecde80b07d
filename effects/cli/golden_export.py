"""What ``fixedpipe golden export`` writes: vectors of states, of rules in two forms, or code."""

from fixedpipe.effects.cli.options import refuse_ignored
from fixedpipe.effects.refusal import Refusal, refusals
from fixedpipe.effects.reports.files import writable_folder

SINGLE_STEP = "singlestep"
FORMS = ("lines", SINGLE_STEP)


def check_options(context, rules, code, form):
    """Raise Refusal for combinations of options in which one would be ignored."""
    if code and rules:
        raise Refusal("--code writes functions and --rules vectors; give one of them.")
    if code:
        why = f"--code {code} writes the same functions always; leave it out"
        refuse_ignored(context, ("profile", "cases", "frames", "seed", "form"), why)
    elif rules:
        why = "--rules writes the NV2A's arithmetic and no frames; leave it out"
        refuse_ignored(context, ("profile", "frames"), why)
    elif form == SINGLE_STEP:
        raise Refusal(f"--form {SINGLE_STEP} is a form of the rules' vectors; give --rules too.")


def export_code(folder, language):
    """Write the rules' functions. Returns a sentence about what was written."""
    from fixedpipe.effects.emulators.code import code_files, functions
    from fixedpipe.effects.reports.golden.vectors import write_code

    folder = writable_folder(folder)
    known = functions(language)
    with refusals():
        written = write_code(folder, lambda version: code_files(language, version), known)
    one = "nv2a.h" if language == "c99" else "nv2a.glsl"
    return (
        f"{len(written)} files with {len(known)} rules' functions are in {folder}; {one} has all, and "
        "index.json says which is whose."
    )


def export_rules(folder, cases, seed, form):
    """Write the rules' vectors. Returns the files' names."""
    from fixedpipe.effects.reports.golden.vectors import write_rules, write_single_steps

    with refusals():
        return (write_single_steps if form == SINGLE_STEP else write_rules)(folder, cases, seed)
