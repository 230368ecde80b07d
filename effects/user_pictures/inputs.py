"""What users bring, read whole or refused: texts, photographs, elevation models, meshes and volumes, and the
samples that need no file.
"""

import importlib.util
import math
import sys
from pathlib import Path

import numpy as np

from fixedpipe.effects.refusal import Refusal

# Pictures inside the wheels of the extra `samples`; nothing is downloaded. Package, path, array of an NPZ.
SAMPLES = {
    "gravel": ("skimage", "data/gravel.png", None),
    "brick": ("skimage", "data/brick.png", None),
    "grass": ("skimage", "data/grass.png", None),
    "coins": ("skimage", "data/coins.png", None),
    "moon": ("skimage", "data/moon.png", None),
    "jacksboro": ("matplotlib", "mpl-data/sample_data/jacksboro_fault_dem.npz", "elevation"),
}

# Modes of files whose components are not red, green, blue or grey.
_OTHER_COLORS = ("CMYK", "YCbCr", "LAB", "HSV")


def _sample_path(name):
    from fixedpipe.effects.refusal import choose

    package, path, array = choose("sample", name, SAMPLES)
    found = importlib.util.find_spec(package)
    whole = Path(found.origin).parent / path if found else None
    if whole is None or not whole.is_file():
        raise Refusal(f"The sample {name!r} needs the extra `samples`: pip install 'fixedpipe[samples]'.")
    return whole, array


def read_picture(name):
    """A photograph or an elevation array, top row first: [rows, columns] or [rows, columns, components].

    ``name``: a PNG, TIFF or other image file, a NumPy array (.npy), or ``sample:`` and a name of ``SAMPLES``.
    Raises Refusal for anything that cannot be read whole.
    """
    if name.startswith("sample:"):
        path, array = _sample_path(name.removeprefix("sample:"))
        if array:
            with np.load(path, allow_pickle=False) as arrays:
                return arrays[array]
    else:
        path = Path(name)
    if not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. Give a PNG, TIFF or NPY file, or sample:gravel.")
    try:
        if path.suffix.lower() == ".npy":
            picture = np.load(path, allow_pickle=False)
        else:
            import imageio.v3 as imageio

            with imageio.imopen(path, "r", plugin="pillow") as file:
                mode = file.metadata(index=0)["mode"]
                picture = np.asarray(file.read(index=0, mode="RGB" if mode in _OTHER_COLORS else None))
    # A decoder fed arbitrary bytes raises whatever it stumbles over: struct.error, SyntaxError, EOFError.
    except Exception as error:
        # imageio wraps the decoder's own words.
        reason = str(error.__cause__ or error).split("\n")[0].rstrip(".")
        raise Refusal(f"{name} cannot be read ({reason}). Give a whole PNG, TIFF or NPY file.") from error
    if picture.dtype.kind not in "biuf":
        raise Refusal(f"{name} holds values of type {picture.dtype}; give an array of numbers.")
    return picture


def read_text(name, otherwise=None):
    """The text of a file, or of standard input for ``-``, its lines ended by newlines.

    ``otherwise``: the encoding of what is not UTF-8. Raises Refusal when there is no such file, or no text.
    """
    try:
        data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            if otherwise is None:
                raise
            text = data.decode(otherwise)
        return text.replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise Refusal(f"{name} is not a text file ({error.reason} at byte {error.start}).") from error
    except OSError as error:
        raise Refusal(f"{name} cannot be read: {error.strerror}.") from error
    except ValueError as error:
        raise Refusal(f"{name!r} cannot be read: {error}.") from error


# Assumed: no mesh of so many bytes or triangles is drawn within a minute.
_LARGEST_MESH, _MOST_TRIANGLES = 256 << 20, 500_000


def read_mesh(name):
    """A surface from an OBJ or a PLY file, with the file's normals or, at edges, creases. PLY files need the
    extra ``meshes``.

    Raises Refusal for anything else, and ValueError with a sentence where the mesh has no faces, vertices
    that are no finite numbers, or no area.
    """
    from fixedpipe.effects.geometry.triangle_meshes import read_obj, triangle_mesh, with_creases

    path, kind = Path(name), Path(name).suffix.lower()
    if kind not in (".obj", ".ply"):
        raise Refusal(f"{name!r} is no mesh; give an OBJ or a PLY file.")
    try:
        size = path.stat().st_size
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refusal(f"{name} cannot be read: {reason}.") from error
    if not path.is_file():
        raise Refusal(f"{name} is no file; give an OBJ or a PLY file.")
    if size > _LARGEST_MESH:
        raise Refusal(
            f"{name} has {size >> 20} MiB; meshes of up to {_LARGEST_MESH >> 20} MiB are read. Make it "
            "coarser."
        )
    text = read_text(name) if kind == ".obj" else None
    surface = read_obj(text, name) if kind == ".obj" else triangle_mesh(*_read_ply(path), name)
    if len(surface.triangles) > _MOST_TRIANGLES:
        raise Refusal(
            f"{name} has {len(surface.triangles)} triangles; up to {_MOST_TRIANGLES} are drawn. Make it "
            "coarser."
        )
    return surface if text and "\nvn " in text else with_creases(surface)


def _read_ply(path):
    """Vertices and triangles of a PLY file. Raises Refusal."""
    try:
        import trimesh
    except ImportError as error:
        raise Refusal(
            f"{path} needs the extra `meshes`: pip install 'fixedpipe[meshes]'. OBJ files need nothing."
        ) from error
    try:
        # Vertices and faces as they are: nothing merged, nothing left out.
        mesh = trimesh.load_mesh(path, file_type="ply", process=False)
        vertices, faces = np.array(mesh.vertices), np.array(getattr(mesh, "faces", np.zeros((0, 3))))
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    # A reader fed arbitrary bytes raises whatever it stumbles over.
    except Exception as error:
        reason = (str(error) or type(error).__name__).split("\n")[0].rstrip(".")
        raise Refusal(f"{path} cannot be read ({reason}). Give a whole PLY or OBJ file.") from error
    return vertices, faces


_LARGEST_FILE = 1 << 30  # voxels


def read_raw_volume(path, dims, dtype, skip):
    """Values of a raw file, [slices, rows, columns]. ``dims``: columns, rows and slices; ``dtype``: a value's
    type; ``skip``: bytes before the first.

    Raises Refusal for dimensions that are none or not the file's, and a file that cannot be read.
    """
    try:
        counts = tuple(int(c) for c in dims.split(","))
    except ValueError:
        counts = ()
    if len(counts) != 3 or min(counts) < 2 or math.prod(counts) > _LARGEST_FILE:
        raise Refusal(f"The dimensions are {dims!r}; give three whole numbers from 2, as 256,256,110.")
    dtype = np.dtype(dtype)
    needed = math.prod(counts) * dtype.itemsize
    try:
        there = path.stat().st_size - skip
        if there != needed:
            before = f" after the {skip} skipped" if skip else ""
            raise Refusal(
                f"{path} has {there} bytes{before}; {dims} values of {dtype.name} are {needed}. Give other "
                "--dims, --type or --skip."
            )
        values = np.fromfile(path, dtype, math.prod(counts), offset=skip)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from error
    return values.reshape(counts[::-1])


def read_nrrd(path):
    """Values of an NRRD file, [slices, rows, columns], and the spacing of its voxels. Raises Refusal where it
    has none.
    """
    try:
        import nrrd
    except ImportError as error:
        raise Refusal("NRRD files need the extra `volumes`: pip install 'fixedpipe[volumes]'.") from error
    # A decoder fed arbitrary bytes raises whatever it stumbles over.
    try:
        header = nrrd.read_header(str(path))
        sizes = [int(n) for n in header["sizes"]]
        if len(sizes) == 3 and math.prod(sizes) > _LARGEST_FILE:
            raise ValueError(f"{'x'.join(map(str, sizes))} voxels are too many")
        values, header = nrrd.read(str(path), index_order="C")
    except Exception as error:
        reason = str(error).split("\n")[0].rstrip(".") or type(error).__name__
        raise Refusal(f"{path} cannot be read ({reason}). Give a whole NRRD file.") from error
    return values, _nrrd_spacing(header)


def _nrrd_spacing(header):
    """Spacings of an NRRD header's axes, which may be negative; equal where it has none.

    What is there but is no number is given back as it is, for ``volume_of`` to refuse.
    """
    axes = header.get("space directions")
    if axes is not None:
        return tuple(np.sqrt((np.asarray(axes, float) ** 2).sum(axis=-1)).tolist())
    spacing = header.get("spacings")
    return (1.0, 1.0, 1.0) if spacing is None else tuple(abs(float(s)) for s in spacing)
