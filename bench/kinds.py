"""Which kinds of instructions a fragment takes, of the code that a party compiles while it runs.

Valgrind's callgrind counts every instruction by its address, the process writes its executable memory before
it ends (``bench.counted``), and objdump says what stood there. Libraries and the interpreter are left out.
"""

import bisect
import re
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

from bench.counted import read_dump

FRAMES, EDGE = 4, 512
VALGRIND = (
    "valgrind",
    "--tool=callgrind",
    "--dump-instr=yes",
    "--compress-pos=no",
    "--compress-strings=no",
    "--smc-check=all-non-file",
)
# A mnemonic is of the first kind whose expression it fits; what fits none is a scalar's.
KINDS = {
    "divisions": r"v?(div|sqrt)[ps][ds]|i?div[lqwb]?",
    "gathers": r"v(p?gather|gather)\w+",
    "conversions": r"v?cvt\w+",
    "float64": r"v?(add|sub|mul|min|max|round|cmp\w*|and|andn|or|xor|addsub|hadd|fn?m\w+)[ps]d",
    "float32": r"v?(add|sub|mul|min|max|round|cmp\w*|and|andn|or|xor|addsub|hadd|fn?m\w+|rcp|rsqrt)[ps]s",
    "arranging": r"v?(p?shuf|p?unpck|pack|p?perm|p?blend|p?insr?|p?extr|p?broadcast|palign|p?movmsk|"
    r"pmov[sz]x|movddup|movs[lh]dup|mov[lh]l?[hp])\w*",
    "moves": r"v?mov\w*|vmaskmov\w*|vpmaskmov\w*",
    "integers": r"v?p\w+",
}
_PATTERNS = {kind: re.compile(f"(?:{pattern})$") for kind, pattern in KINDS.items()}
# Names that look like a vector's and are not.
_SCALAR = re.compile(r"(push|pop|pdep|pext[lq]?$|prefetch|pause)")
# Code that is further apart than this is disassembled by itself, bytes; an instruction has 15 at most.
_APART, _LONGEST = 64, 16


def kind_of(mnemonic):
    """The key of ``KINDS`` that an instruction belongs to; "scalars" where none does."""
    if _SCALAR.match(mnemonic):
        return "scalars"
    return next((kind for kind, pattern in _PATTERNS.items() if pattern.match(mnemonic)), "scalars")


def executed(lines):
    """address -> how often it was executed, of callgrind's lines: of code in no file alone."""
    counts, in_no_file, is_call = Counter(), True, False
    for line in lines:
        if line.startswith("ob="):
            in_no_file = line.strip() in ("ob=", "ob=???")
        elif line.startswith("calls="):
            is_call = True  # the next line has what the called function took
        elif line.startswith("0x"):
            if in_no_file and not is_call:
                address, _, number = line.split()
                counts[int(address, 16)] += int(number)
            is_call = False
    return counts


def disassembled(code, address):
    """address -> (mnemonic, operands) of machine code that lies at an address."""
    with tempfile.NamedTemporaryFile() as file:
        file.write(code)
        file.flush()
        options = ["-D", "-b", "binary", "-m", "i386:x86-64", "--no-show-raw-insn"]
        said = subprocess.run(
            ["objdump", *options, f"--adjust-vma={address}", file.name],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
    rows = re.findall(r"^\s*([0-9a-f]+):\s+(\S+)[ \t]*(.*)$", said, re.MULTILINE)
    return {int(at, 16): (mnemonic, operands) for at, mnemonic, operands in rows}


def _runs(addresses):
    """(first, last) of sorted addresses that lie close together."""
    first = last = addresses[0]
    for address in addresses[1:]:
        if address - last > _APART:
            yield first, last
            first = address
        last = address
    yield first, last


def tally(counts, regions):
    """(kind -> instructions, those that read or write the stack) of counted addresses.

    ``regions``: [(address, bytes)] of executable memory, sorted.
    """
    starts = [address for address, _ in regions]
    kinds, stack = Counter(), 0

    def region_of(address):
        start, code = regions[max(0, bisect.bisect_right(starts, address) - 1)]
        return (start, code) if start <= address < start + len(code) else None

    known = sorted(address for address in counts if region_of(address))
    for first, last in _runs(known) if known else ():
        start, code = region_of(first)
        part = code[first - start : last - start + _LONGEST]
        for address, (mnemonic, operands) in disassembled(part, first).items():
            if number := counts.get(address):
                kinds[kind_of(mnemonic)] += number
                stack += number * ("(%rsp" in operands or "(%rbp" in operands)
    return kinds, stack


def count(run, command, work):
    """kind -> instructions a fragment, with "all" and "stack" (reading or writing it), of a party.

    run      runs a command to its end, or raises OSError
    command  of ``bench.counted`` without the number of frames
    work     fragments, or triangles, of a frame
    """
    with tempfile.TemporaryDirectory() as folder:
        counted, dump = Path(folder, "callgrind"), Path(folder, "memory.npz")
        run([*VALGRIND, f"--callgrind-out-file={counted}", *command, str(FRAMES), str(dump)])
        with counted.open() as lines:
            counts = executed(lines)
        kinds, stack = tally(counts, read_dump(dump))
    frames = FRAMES + 1
    found = {"all": sum(kinds.values()), "stack": stack} | {kind: kinds[kind] for kind in (*KINDS, "scalars")}
    return {name: number / (work * frames) for name, number in found.items()}
