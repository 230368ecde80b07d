"""Changed copies of small files, given to the readers of what users bring: each is read, or refused in one
sentence, within 10 seconds and 1.5 GB.

``python -m tests.mutants --count 10000`` changes every kind of file so many times; ``--only deep.tiff`` one
kind. It runs in a process of its own, for a library that crashes would end it; the last mutant is kept where
``--folder`` says, and what went wrong is said with the seed.
"""

import argparse
import random
import re
import resource
import signal
import struct
import sys
import tempfile
import warnings
from pathlib import Path

from tests.support import user_files
from tests.support.memory import largest_memory

BYTES, SECONDS = 1_500_000_000, 10
# Bytes that headers are made of, and numbers at which sizes go wrong.
_TEXT = b"0123456789-. \n+XY:="
_NUMBERS = (0, 1, 2, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
# What only Python, NumPy or a decoder says.
LEAKS = (
    *("StopIteration", "pickle", "buffer", "unpack", "Error", "Traceback", "object at"),
    *("None", "<class", "('", "dtype", "=-", "argument"),
)


class Late(BaseException):
    """A reader took longer than SECONDS."""


def changed(data, seed):
    """One to four places changed: a byte, a number of two or four bytes, bytes taken out, put twice or moved
    in from elsewhere.
    """
    chance, out = random.Random(seed), bytearray(data[: 1 << 16])
    for _ in range(chance.randint(1, 4)):
        at = chance.randrange(len(out)) if len(out) > 1 else 0
        at = chance.randrange(min(at + 1, 200)) if chance.random() < 0.5 else at  # headers are first
        how = chance.randrange(7)
        some = chance.randint(1, 8)
        if how == 0:
            out[at : at + 1] = bytes([chance.randrange(256)])
        elif how == 1:
            out[at : at + 1] = bytes([chance.choice(_TEXT)])
        elif how == 2:
            del out[at : at + some]
        elif how == 3:
            out[at:at] = out[at : at + some]
        elif how == 4:
            form = chance.choice(("<H", ">H", "<I", ">I"))
            number = chance.choice(_NUMBERS) & (0xFFFF if form[1] == "H" else 0xFFFFFFFF)
            out[at : at + struct.calcsize(form)] = struct.pack(form, number)
        elif how == 5:
            other = chance.randrange(max(len(out), 1))
            out[at : at + some] = out[other : other + some]
        else:
            del out[max(at, 1) :]
    return bytes(out) + data[1 << 16 :]


def outcome(path, data, read):
    """The sentence of a refusal, or None where the file is read. Anything else is raised."""
    path.write_bytes(data)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # the terminal of a user is no place for a library's warnings
        try:
            read(str(path))
        except ValueError as refused:  # Refusal is one, and what the meshes' own module raises
            if type(refused) is not ValueError and type(refused).__name__ != "Refusal":
                raise
            return str(refused)
    return None


def wrong_with(sentence, path):
    """What is wrong with a refusal's sentence; empty where nothing is."""
    words = sentence.replace(str(path), "")
    # What a sentence quotes of the file may end with a parenthesis: no tuple's.
    marks = re.sub(r"'(?:[^'\\]|\\.)*'", "'quoted'", words)
    leaks = [leak for leak in LEAKS if leak in (marks if leak == "('" else words)]
    if path.name not in sentence or not sentence.endswith(".") or "\n" in sentence or leaks:
        return f"{sentence!r} is no sentence for a user {leaks}"
    return ""


def try_mutants(folder, name, count, first_seed=0):
    """Give a kind's mutants to its reader; returns how many were read."""
    data, read = user_files.files(folder)[name]
    path, whole = Path(folder) / name, 0

    def late(*_):
        raise Late

    signal.signal(signal.SIGALRM, late)
    for seed in range(first_seed, first_seed + count):
        signal.alarm(SECONDS)
        try:
            sentence = outcome(path, changed(data, seed), read)
        except BaseException as error:
            error.add_note(f"{name}, seed {seed}")
            raise
        finally:
            signal.alarm(0)
        whole += sentence is None
        if sentence and (wrong := wrong_with(sentence, path)):
            raise AssertionError(f"{name}, seed {seed}: {wrong}")
    return whole


def main(arguments=None):
    """Parse the command line and try."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__.split("\n\n")[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--only", action="append")
    parser.add_argument("--folder", default=None)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.folder or temporary
        names = given.only or list(user_files.files(folder))
        resource.setrlimit(resource.RLIMIT_DATA, (BYTES, BYTES))
        for name in names:
            print(f"{name}: ", end="", flush=True)
            whole = try_mutants(folder, name, given.count, given.first_seed)
            print(f"{given.count} mutants, {whole} read, the others refused", flush=True)
    most = largest_memory()
    print(f"At most {most / 1e6:.0f} MB")
    return 0 if most < BYTES else 1


if __name__ == "__main__":
    sys.exit(main())
