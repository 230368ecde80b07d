"""G27 and G29: a bidirectional texture function, which is the goniometer's stored pictures, and its windows'
BRDFs.

A picture shows one period of the field from v, with light from l. It is registered to the field's mean plane,
so a pixel is the same place of the material in all pictures. For a diffuse field, a picture is the light of
the texels (``goniometer.lights``) at the visible ones (``goniometer.picture``), which do not depend on l.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 6 and 7; pass sequences A-G27 and A-G29. Assumed:
float16 or bytes; the paper does not say how a BTF would be stored.
"""

import io
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.scattering import goniometer, long_work
from fixedpipe.effects.technique import Technique

TECHNIQUES = (
    Technique("G27", "a bidirectional texture function: the goniometer's pictures themselves", "6"),
    Technique("G29", "BRDFs that vary over the surface: means over windows of those pictures", "1, 2, 6, 7"),
)

# Of a picture's numbers in bytes: 255 is this radiance, 1 = a white surface that faces the light.
FULL = 2.0


@dataclass(frozen=True, eq=False)
class BTF:
    """Pictures [n, m, size, size, 3], bottom row first, of n lights and m views; float16, 1 = a white surface
    that faces the light, or uint8, 255 = ``FULL``.

    towards, views  float64 [n, 3] and [m, 3]
    irradiance      float64 [n]: of the mean plane (``goniometer.irradiance``)
    """

    pictures: NDArray
    towards: NDArray[np.float64]
    views: NDArray[np.float64]
    irradiance: NDArray[np.float64]

    def radiance(self, light, view):
        """One picture, by the numbers of light and view: float64 [size, size, 3]."""
        kept = self.pictures[light, view].astype(np.float64)
        return kept * (FULL / 255.0) if self.pictures.dtype == np.uint8 else kept

    def windows(self, count):
        """G29: f_r of ``count`` x ``count`` windows of the surface: float64 [n, m, count, count, 3], bottom
        row first.

        Raises ValueError where the pictures have no whole pixels in each.
        """
        size = self.pictures.shape[2]
        if count < 1 or size % count:
            raise ValueError(f"{count} windows do not share {size} pixels; give a divisor.")
        edge = size // count
        out = np.empty((len(self.towards), len(self.views), count, count, 3))
        for i in range(len(self.towards)):
            for j in range(len(self.views)):
                parts = self.radiance(i, j).reshape(count, edge, count, edge, 3)
                out[i, j] = parts.sum(axis=(1, 3)) / (edge * edge * math.pi * self.irradiance[i])
        return out

    def brdf(self):
        """G23: f_r of the whole: float64 [n, m, 3]."""
        return self.windows(1)[:, :, 0, 0]

    def npz(self):
        """The bytes of an NPZ file: the arrays by their names, and ``full``, what 255 is in bytes."""
        stream, names = io.BytesIO(), ("pictures", "towards", "views", "irradiance")
        np.savez(stream, **{name: getattr(self, name) for name in names}, full=FULL)
        return stream.getvalue()


def _piece(task):
    field, visibility, light, texels, bounces, kind = task
    sent = goniometer.lights(field, visibility, light[None], bounces)[0].reshape(-1, 3)
    pictures = sent[texels]
    if kind == "uint8":
        return np.floor(np.clip(pictures / FULL, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
    return pictures.astype(np.float16)


def simulated(
    field,
    visibility,
    towards,
    views,
    *,
    size=None,
    bounces=2,
    kind="float16",
    folder=None,
    executor=None,
    progress=None,
):
    """The BTF of a diffuse HeightField for all pairs of lights [n, 3] and views [m, 3].

    size     pixels along a picture's edge; None: one for each texel along the longer edge
    kind     "float16" or "uint8"
    folder, executor, progress  as for ``long_work.run``; a piece is one light

    Raises ValueError for directions that are none or not above the horizon, another kind, and a field with
    highlights, and Refusal as ``long_work.run``.
    """
    towards, views = goniometer.upper(towards, "The lights"), goniometer.upper(views, "The views")
    if field.specular:
        raise ValueError("The field has highlights, which differ with the view; give a diffuse one.")
    if kind not in ("float16", "uint8"):
        raise ValueError(f"Pictures are kept as {kind!r}; give 'float16' or 'uint8'.")
    size = max(field.rows, field.columns) if size is None else size
    texels = np.stack([goniometer.picture(field, view, size) for view in views])
    parameters = {
        "what": "BTF",
        "heights": long_work.array_digest(field.heights),
        "normals": long_work.array_digest(field.normals),
        "albedo": long_work.array_digest(field.albedo),
        "gathered along": long_work.array_digest(visibility.directions),
        "lights": long_work.array_digest(towards),
        "views": long_work.array_digest(views),
        "size": size,
        "bounces": bounces,
        "kind": kind,
    }
    tasks = [(field, visibility, light, texels, bounces, kind) for light in towards]
    found = long_work.run(
        tasks, _piece, folder=folder, parameters=parameters, executor=executor, progress=progress
    )
    return BTF(np.stack(found), towards, views, goniometer.irradiance(field, towards))
