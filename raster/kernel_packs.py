"""A pack: the compiled kernels of one state of the sources, for one level of processors, in one file.

It is read in place, by every process that finds it in a folder of kernels or in the installed package. A pack
begins with a line that says what it is. A digest follows, then the length of its index, the index as
compressed JSON, and the kernels, each compressed. Nothing is unpickled before its digest was compared.

A pack is code. Whoever reads one trusts its writer.
"""

import hashlib
import json
import os
import pickle
import struct
import sys
import zlib
from contextlib import suppress
from functools import cache
from pathlib import Path

import llvmlite
import llvmlite.binding as llvm
import numba

from fixedpipe.raster.kernel_levels import LEVELS, levels_here

SUFFIX = ".pack"
_MAGIC = b"fixedpipe kernels, format 1\n"
_HEAD = struct.Struct("<32sQ")  # the index's digest and length
# Assumed: bytes of an index, compressed and not. The one of all kernels has 20 kB and 100 kB.
_LONGEST, _LARGEST = 1 << 22, 1 << 24
_FACTS = {
    "python": ("Python", sys.implementation.cache_tag),
    "numba": ("Numba", numba.__version__),
    "llvmlite": ("llvmlite", llvmlite.__version__),
    "system": ("the system", llvm.get_process_triple()),
}


class PackError(ValueError):
    """A file that is no pack, or one that does not fit here: a sentence says why."""


def _text(key):
    """A key of Numba's cache as text: the signature and digests of the function. The processor is left out,
    as it is the pack's.
    """
    signature, _, digests = key
    return "\n".join([str(signature), *digests])


class Pack:
    """An open pack: ``facts`` by name, and which kernels it has."""

    def __init__(self, path):
        self.path = Path(path)
        try:
            with self.path.open("rb") as file:
                if file.read(len(_MAGIC)) != _MAGIC:
                    raise PackError(f"{path} is no pack of kernels; `fixedpipe cache pack FILE` writes one.")
                digest, length = _HEAD.unpack(file.read(_HEAD.size))
                packed = file.read(length) if length <= _LONGEST else b""
        except struct.error:
            packed = b""
        except OSError as error:
            raise PackError(f"{path} cannot be read: {error.strerror}.") from error
        if not packed or hashlib.sha256(packed).digest() != digest:
            raise PackError(f"{path} is damaged: its index is not what was written; fetch it again.")
        index = json.loads(zlib.decompressobj().decompress(packed, _LARGEST))
        self.facts, self._kernels = index["facts"], index["kernels"]
        self.level = next((level for level in LEVELS if level.name == self.facts["level"]), None)
        self._begin = len(_MAGIC) + _HEAD.size + length

    def check_fits(self, state):
        """Raise PackError where its kernels are not those of this state, Python, Numba and system."""
        for name, (words, here) in _FACTS.items():
            if self.facts[name] != here:
                raise PackError(
                    f"{self.path} has kernels for {words} {self.facts[name]}, and here is {here}."
                )
        if self.facts["state"] != state:
            raise PackError(
                f"{self.path} has kernels of other sources, {self.facts['state']}; these are {state}."
            )

    def check_runs(self):
        """Raise PackError where this process may not run its kernels."""
        if self.level not in levels_here():
            lacking = self.level.lacking() if self.level else []
            why = f"this processor has no {', '.join(lacking)}" if lacking else "others are asked for here"
            raise PackError(f"{self.path} has kernels for {self.facts['level']}, and {why}.")

    def check_whole(self):
        """Raise PackError where a kernel's bytes are not what was written."""
        for name, kernels in self._kernels.items():
            for key in kernels:
                if self._bytes(name, key) is None:
                    raise PackError(f"{self.path} is damaged: kernel {name}; fetch it again.")

    def load(self, name, key):
        """What was packed of a kernel; None where it is not there, whole."""
        data = self._bytes(name, _text(key))
        return None if data is None else pickle.loads(zlib.decompress(data))

    def _bytes(self, name, key):
        found = self._kernels.get(name, {}).get(key)
        if found is None:
            return None
        begin, length, digest = found
        with suppress(OSError), self.path.open("rb") as file:
            file.seek(self._begin + begin)
            data = file.read(length)
            if hashlib.sha256(data).hexdigest() == digest:
                return data
        return None

    def __len__(self):
        return sum(map(len, self._kernels.values()))


def write_pack(path, state, level, kernels):
    """Write a pack; it is there whole or not at all.

    kernels   (name, key of Numba's cache, pickled bytes) of each
    """
    index, blobs, at = {}, [], 0
    for name, key, data in kernels:
        blob = zlib.compress(data, 9)
        index.setdefault(name, {})[_text(key)] = at, len(blob), hashlib.sha256(blob).hexdigest()
        blobs.append(blob)
        at += len(blob)
    facts = {name: here for name, (_, here) in _FACTS.items()} | {"state": state, "level": level}
    packed = zlib.compress(json.dumps({"facts": facts, "kernels": index}, sort_keys=True).encode(), 9)
    head = _HEAD.pack(hashlib.sha256(packed).digest(), len(packed))
    unfinished = Path(f"{path}.{os.getpid()}.tmp")
    try:
        unfinished.write_bytes(b"".join([_MAGIC, head, packed, *blobs]))
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


@cache
def packs_in(folders, state):
    """(the packs in these folders that can be used, the best first; a sentence for each that does not fit).

    One for a level that this processor lacks is no reason for a sentence: packs of all levels are shipped.
    """
    found, refused = [], []
    for path in (path for folder in folders for path in sorted(Path(folder).glob(f"*{SUFFIX}"))):
        try:
            pack = Pack(path)
            pack.check_fits(state)
            found.append(pack)
        except PackError as error:
            refused.append(str(error))
    usable = [pack for level in levels_here() for pack in found if pack.level == level]
    return tuple(usable), tuple(refused)
