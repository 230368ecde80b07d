"""The provenance of a result: versions, and the digest of the kernels' sources."""

import platform
from importlib import metadata

from fixedpipe.raster import kernel


def kernels_are_cold():
    """Whether the kernels must still be compiled, once, before the first picture."""
    return kernel.is_cold()


def package_version():
    """The installed distribution's version, or "not installed" where the source folders are used."""
    try:
        return metadata.version("fixedpipe")
    except metadata.PackageNotFoundError:
        return "not installed"


def provenance(profile):
    """What drew a picture, as a dict for a JSON file: profile, versions, digest of the kernels' sources.

    ``profile`` is None where several machines took part.
    """
    return {
        "profile": profile.name if profile else None,
        "fixedpipe": package_version(),
        "kernels": kernel.CACHE_FOLDER.name,
        "python": platform.python_version(),
        "numpy": metadata.version("numpy"),
        "numba": metadata.version("numba"),
        "architecture": platform.machine(),
    }
