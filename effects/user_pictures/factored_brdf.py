"""A user's BRDF on a mesh by products of textures, on any machine: from a file or an object to commands.

A BRDF is an object or a file. An object has ``at(lights, views)``. Its arguments are float64 [n, 3] each,
unit vectors above the horizon in the surface's frame (tangent, binormal, normal); it gives f_r, float64 [n,
3], RGB per steradian. A file is a table of the MERL database (.binary), or an NPZ file with ``samples`` (as
``simulated_brdf`` writes it).

``commands`` does all. ``factored`` and ``drawn`` are its halves, for many pictures of one BRDF.

Source: Heidrich 2001, section 1.1.2 (H17 and H18 of the catalogue).
"""

import zipfile
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np

from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.reflectance import factored_passes, homomorphic_factors, separable_factors
from fixedpipe.effects.reflectance.hemisphere_maps import Halves
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.scattering import merl
from fixedpipe.effects.scattering.dense_brdf import DenseBRDF
from fixedpipe.effects.user_pictures import arrays
from fixedpipe.effects.user_pictures.reading import SAMPLES, check_count, whole

_FILES = "Give a MERL table (.binary) or an NPZ file with an array `samples` [n, n, n, n, 3]."
# Texels along an edge of the maps at whose directions the ways are compared.
_COMPARED = 16


class Factorisation(Enum):
    """How a BRDF becomes textures."""

    HOMOMORPHIC = "homomorphic"
    HALFWAY = "separable by halfway and difference vector"
    DIRECTIONS = "separable by light and view"


@dataclass(frozen=True, eq=False)
class Factored:
    """A BRDF's factors: ``factors``, Homomorphic- or SeparableFactors; ``way``, how they were found;
    ``error``, their RMS error over the BRDF's RMS, where pairs of light and view count by the squares of
    their cosines.
    """

    factors: object
    way: Factorisation
    error: float


def read(name):
    """The BRDF of a file, an object with ``at``. Raises Refusal if it is no such file."""
    path = Path(name)
    if not path.is_file():
        problem = f"{name} is no file" if str(name) and path.exists() else f"There is no file {str(name)!r}"
        raise Refusal(f"{problem}. {_FILES}")
    try:
        with path.open("rb") as file:
            if file.read(2) == b"PK":
                return _dense(path)
            file.seek(0)
            return merl.MeasuredBRDF(merl.read(file.read(merl.BYTES + 1)))
    except OSError as error:
        raise Refusal(f"{name} cannot be read: {error.strerror or error}.") from error
    except Refusal:
        raise
    except ValueError as error:
        raise Refusal(f"{name}: {error} {_FILES}") from error


def _dense(path):
    """The DenseBRDF of an NPZ file, whose array's header is looked at before anything is unpacked."""
    cure = f"Write it with fixedpipe brdf, or numpy.savez. {_FILES}"
    with whole(path, "is a damaged NPZ file", cure), zipfile.ZipFile(path) as members:
        if "samples.npy" not in members.namelist():
            raise Refusal(f"{path}: The NPZ file has no array `samples`. {_FILES}")
        member = members.getinfo("samples.npy")
        if member.flag_bits & 1:
            raise Refusal(f"{path} is an encrypted NPZ file. {cure}")
        # zipfile unpacks what others packed without a bound.
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            raise Refusal(f"{path} is an NPZ file packed by method {member.compress_type}. {cure}")
        with members.open("samples.npy") as file:
            found = arrays.header(file)
            if wrong := _wrong(found):
                raise Refusal(f"{path}: {wrong} {_FILES}")
            check_count(path, found.shape[:4], "samples", SAMPLES)
            samples = arrays.values(file, found, path)
            if file.read(1):
                raise Refusal(f"{path} has more values than the {found.shape} that it names. {cure}")
    return dense(samples)


_NO_NUMBERS = "The samples are not all finite numbers; give f_r per steradian."


def _wrong(array):
    """What is wrong with samples' shape or type, a sentence; None: nothing is."""
    shape = array.shape
    if len(shape) != 5 or shape[4] != 3 or not 0 < shape[0] == shape[1] == shape[2] == shape[3]:
        return f"The samples have shape {shape}; give [n, n, n, n, 3]."
    return None if array.dtype.kind in "fiu" else _NO_NUMBERS


def dense(samples):
    """The DenseBRDF of samples [n, n, n, n, 3], as its own are. Raises ValueError for anything else."""
    samples = np.asarray(samples)
    if wrong := _wrong(samples):
        raise ValueError(wrong)
    if not np.isfinite(samples).all():
        raise ValueError(_NO_NUMBERS)
    if not samples.any():
        raise ValueError("The samples are all zero; there is nothing to factor.")
    if samples.min() < 0:
        raise ValueError(
            f"The samples go down to {samples.min():g}; f_r is zero or more, so give none below."
        )
    return DenseBRDF(samples.astype(np.float64, copy=False))


def brdf_of(brdf):
    """An object with ``at``: a file's name is read, an array [n, n, n, n, 3] is a dense grid of samples.

    Raises ValueError (Refusal) for anything else.
    """
    if callable(getattr(brdf, "at", None)):
        return brdf
    if isinstance(brdf, str | Path):
        return read(brdf)
    if not hasattr(brdf, "shape"):
        raise ValueError(f"The BRDF is {brdf!r}; give an object with at(lights, views), or a file. {_FILES}")
    return dense(brdf)


def _found(brdf, way, size, terms):
    if way is Factorisation.HOMOMORPHIC:
        return homomorphic_factors.factored(brdf, size)
    halves = Halves.HALFWAY_AND_DIFFERENCE if way is Factorisation.HALFWAY else Halves.LIGHT_AND_VIEW
    return separable_factors.factored(separable_factors.table(brdf, size, halves), terms)


def _error(factors, table):
    """Of factors at a table's lights and views."""
    count = len(table.samples)
    texels = separable_factors.texels(table.size)
    lights, views = np.repeat(texels, count, axis=0), np.tile(texels, (count, 1))
    return table.error(factors.at(lights, views).reshape(table.samples.shape))


def factored(brdf, way=None, *, size=32, terms=2):
    """The Factored of a BRDF, or of a file's name.

    way    a Factorisation, or its text; None: the one of all three with the smallest error (Measured: 4 s for
           32 texels)
    size   texels along an edge of the factors' maps, from 4 to 64
    terms  products that separable factors add, from 1 to 8

    Raises ValueError (Refusal for a file) for anything else.
    """
    brdf = brdf_of(brdf)
    if isinstance(way, str):
        named = {each.value: each for each in Factorisation} | {
            each.name.lower(): each for each in Factorisation
        }
        if way not in named:
            raise ValueError(f"There is no way {way!r}; give one of {', '.join(map(repr, named))}.")
        way = named[way]
    ways = (
        tuple(Factorisation)
        if way is None
        else (member_of(Factorisation, way, "The way in which a BRDF is factored"),)
    )
    compared = separable_factors.table(brdf, _COMPARED, Halves.LIGHT_AND_VIEW)
    best = None
    for each in ways:
        factors = _found(brdf, each, size, terms)
        error = _error(factors, compared)
        if best is None or error < best.error:
            best = Factored(factors, each, error)
    return best


def drawn(found, surface, view, light, profile, *, intensity=1.0, name="BRDF"):
    """Commands that draw a surface with a Factored, over the window's contents.

    surface    a Surface, whose tangents are the BRDF's first axis
    light      a ``views.Light``
    intensity  the light's: a white surface that faces it has this brightness
    name       of the textures

    Raises ValueError for an intensity that is not positive.
    """
    loading, loaded = factored_passes.load(found.factors, name, profile, intensity=intensity)
    return (*loading, *factored_passes.passes(surface, loaded, view, light))


def commands(brdf, surface, view, light, profile, *, way=None, size=32, terms=2, intensity=1.0):
    """Commands that draw a surface with a BRDF by factors, on any machine, without clearing: ``factored``,
    then ``drawn``, with their arguments.
    """
    found = factored(brdf, way, size=size, terms=terms)
    return drawn(found, surface, view, light, profile, intensity=intensity)
