"""Files of the command line: pictures and elevation arrays read, results written whole or not at all."""

import importlib.util
import io
import os
import sys
import tempfile
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np

from fixedpipe.effects.cli.refusal import Refusal

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
    from fixedpipe.effects.cli.refusal import choose

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
    from fixedpipe.effects.geometry.surfaces import read_obj
    from fixedpipe.effects.user_pictures.mesh_shadows import triangle_mesh, with_creases

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


def writable_folder(folder):
    """The folder as a path, made if need be. Raises Refusal when nothing can be written there."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        raise Refusal(f"The folder {folder} cannot be written to: {error.strerror}.") from error
    except ValueError as error:
        raise Refusal(f"{str(folder)!r} is no name of a folder: {error}.") from error


def writable_file(name):
    """The file as a path, its folder made if need be. Raises Refusal when it cannot be written."""
    path = Path(name)
    writable_folder(path.parent)
    try:
        if path.is_dir():
            raise Refusal(f"{path} is a folder; name a file in it.")
        handle, probe = _temporary_beside(path)
        os.close(handle)
        probe.unlink()
    except Refusal:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise Refusal(f"{str(path)!r} cannot be written: {reason}.") from error
    return path


def writable_picture(name):
    """``writable_file`` of a PNG file. Raises Refusal for another ending, before any folder is made."""
    path = Path(name)
    if path.name and not os.path.isdir(path) and path.suffix.lower() != ".png":
        raise Refusal(f"The picture is written as PNG; name it {path.with_suffix('.png')} instead of {path}.")
    return writable_file(name)


def _temporary_beside(path):
    """An open handle of a new file in the folder of ``path``, hidden and named after it, and its path."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    return handle, Path(temporary)


def write_whole(path, data):
    """Write bytes under a temporary name, then rename: at no moment is there half a file under ``path``.

    Raises Refusal when it cannot be written. Whatever interrupts it, the temporary file goes.
    """
    temporary = None
    try:
        handle, temporary = _temporary_beside(path)
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        # mkstemp makes a file for its owner alone; give it what an ordinary new file gets.
        mask = os.umask(0)
        os.umask(mask)
        temporary.chmod(0o666 & ~mask)
        temporary.replace(path)
    except BaseException as error:
        if temporary:
            with suppress(OSError):
                temporary.unlink()
        if isinstance(error, OSError):
            raise Refusal(f"{path} cannot be written: {error.strerror}.") from error
        raise


def png(image):
    """A picture as the bytes of a PNG file: uint8 [h, w, 3 or 4], or grey [h, w]; alpha is left out.

    A framebuffer's alpha holds whatever a pass kept there (a gate, a factor) and is no transparency.
    """
    from PIL import Image

    # Of zlib's ways this is a third of the time, and a twentieth more bytes.
    buffer, way = io.BytesIO(), zlib.Z_RLE
    picture = image if image.ndim == 2 else image[..., :3]
    Image.fromarray(np.ascontiguousarray(picture)).save(buffer, "PNG", compress_type=way)
    return buffer.getvalue()
