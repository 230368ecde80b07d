"""Files of high dynamic range, Radiance's and OpenEXR's, as linear red, green and blue, top row first.

The module reads Radiance files itself. OpenImageIO also reads them, but refuses files without a FORMAT line,
old runs, and XYZE, all of which Radiance writes or reads. OpenImageIO reads OpenEXR files, only the channels
that are needed. It refuses luminance with chroma of half the rows and columns; OpenEXR's own library reads
those.

Source: Radiance's file formats (LBNL, "Radiance File Formats": pictures, RGBE and XYZE, resolution strings,
runs); OpenEXR's "Technical Introduction" (windows, layers, luminance and chroma) and its attribute
chromaticities.
"""

import io
import math
import re
from contextlib import redirect_stdout

import numpy as np

from fixedpipe.effects.geometry.vectors import cross, dot
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.user_pictures.picture_files import one_line, turned
from fixedpipe.effects.user_pictures.reading import PIXELS, check_count, silent, whole

# How the files begin.
BEGINNINGS = {b"#?": "Radiance", b"\x76\x2f\x31\x01": "OpenEXR"}
_SAVE_AGAIN = "Save it again."

# ------------------------------------------------------------------------------------------------- colours

# x and y of red, green, blue and white.  Source: ITU-R BT.709.
_REC_709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
# Source: Radiance's color.h.
_RADIANCE = (0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 1 / 3, 1 / 3)
# Cones' responses to XYZ.  Source: Lam 1985, the Bradford transform.
_CONES = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def _times(a, b):
    """A 3x3 matrix, or rows [n, 3], times a 3x3 matrix: each sum from its first term on, on any processor."""
    return (a[:, :1] * b[0] + a[:, 1:2] * b[1]) + a[:, 2:] * b[2]


def _inverse(matrix):
    """By cofactors. Raises LinAlgError if there is none."""
    x, y, z = matrix
    cofactors = np.stack([cross(y, z), cross(z, x), cross(x, y)])
    determinant = float(dot(x, cofactors[0]))
    if determinant == 0.0:
        raise np.linalg.LinAlgError("the matrix has no inverse")
    return cofactors.T / determinant


def _xyz(x, y):
    return np.array([x / y, 1.0, (1.0 - x - y) / y])


def _to_xyz(chromaticities):
    """The matrix from red, green and blue to XYZ, in which white has Y = 1. Raises LinAlgError for none."""
    red, green, blue, white = np.reshape(np.array(chromaticities, np.float64), (4, 2))
    # A primary may have y = 0, as X and Z have.
    primaries = np.array([[x, y, 1.0 - x - y] for x, y in (red, green, blue)]).T
    return primaries * dot(_inverse(primaries), _xyz(*white))


def _adapted(white):
    """The matrix that takes colours seen under a white, x and y, to those under Rec. 709's."""
    before, after = dot(_CONES, _xyz(*white)), dot(_CONES, _xyz(*_REC_709[6:]))
    return _times(_inverse(_CONES) * (after / before), _CONES)


def _converted(colors, matrix):
    """float32 [rows, columns, 3] times a matrix, row by row."""
    for row in colors:
        row[...] = _times(row.astype(np.float64), matrix.T)
    return colors


# ------------------------------------------------------------------------------------------------ Radiance

# Which axis changes from line to line, which along a line, and the orientation (``picture_files.turned``).
_TURNS = {
    **{b"-Y+X": 1, b"-Y-X": 2, b"+Y-X": 3, b"+Y+X": 4},
    **{b"+X-Y": 5, b"-X-Y": 6, b"-X+Y": 7, b"+X+Y": 8},
}
_LONGEST_LINE, _LONGEST_HEADER = 1 << 16, 1 << 20


def radiance(path):
    """(float32 [rows, columns, 3], notes) of a Radiance picture. Raises Refusal."""
    damaged = "begins as a Radiance file and cannot be read to its end: it is cut off or damaged"
    with whole(path, damaged, _SAVE_AGAIN), path.open("rb") as file:
        said, size, orientation = _radiance_header(path, file)
        check_count(path, size[::-1], "pixels", PIXELS)
        colors = np.empty((*size, 3), np.float32)
        # No line has more bytes: runs of one texel take two for each.
        rest, at = memoryview(file.read(size[0] * (8 * size[1] + 4))), 0
        for row in colors:
            texels, at = _scan_line(rest, at, size[1])
            # Source: Ward's rgbe.c; a mantissa of m and an exponent of e are m 2^(e - 136).
            row[...] = np.ldexp(texels[:3].T.astype(np.float32), texels[3][:, None].astype(np.int32) - 136)
            row[texels[3] == 0] = 0.0
        return _seen(turned(colors, orientation), said)


def _radiance_header(path, file):
    """({name: [values]}, (lines, texels of each), orientation)."""
    said = {}
    while line := file.readline(_LONGEST_LINE):
        if file.tell() > _LONGEST_HEADER:
            break
        if found := re.fullmatch(rb"([-+][XY]) +(\d{1,9}) +([-+][XY]) +(\d{1,9})\s*", line):
            first, lines, second, texels = found.groups()
            size = int(lines), int(texels)
            form = next(iter(said.get("FORMAT", ())), _RGBE)
            if form not in _FORMATS:
                form = re.sub(r"[^\w-]", "?", form[:40])
                raise Refusal(f"{path} has the format {form}; Radiance's {' and '.join(_FORMATS)} are read.")
            if first + second in _TURNS and min(size) > 0:
                return said, size, _TURNS[first + second]
            break
        name, _, value = line.strip().decode("latin-1").partition("=")
        said.setdefault(name.strip(), []).append(value.strip())
    raise Refusal(
        f"{path} begins as a Radiance file and cannot be read to its end: it has no line of its size, as "
        f"-Y 512 +X 1024. {_SAVE_AGAIN}"
    )


_RGBE, _XYZE = _FORMATS = "32-bit_rle_rgbe", "32-bit_rle_xyze"


def _scan_line(data, at, count):
    """A line's texels, uint8 [4, count], and where the next begins. Raises IndexError where it ends early."""
    new = data[at : at + 2] == b"\x02\x02" and (data[at + 2] << 8 | data[at + 3]) == count
    if not (8 <= count < 32768 and new):
        return _old_line(data, at, count)
    at += 4
    line = bytearray()
    for component in range(1, 5):
        while len(line) < component * count:
            run = data[at]
            if run > 128:
                line += bytes(data[at + 1 : at + 2]) * (run - 128)
                at += 2
            else:
                line += data[at + 1 : at + 1 + run]
                at += 1 + run
            if not run:
                raise IndexError("a run of none")
        if len(line) != component * count or at > len(data):
            raise IndexError("a run beyond its line")
    return np.frombuffer(line, np.uint8).reshape(4, count), at


def _old_line(data, at, count):
    """Texels as they are, among which 1 1 1 n repeats the last n times, or n times 256 after another such."""
    if b"\x01\x01\x01" not in (plain := bytes(data[at : at + 4 * count])):
        line, at = plain, at + 4 * count
    else:
        line, shift = bytearray(), 0
        while len(line) < 4 * count:
            texel = bytes(data[at : at + 4])
            at += 4
            if texel[:3] == b"\x01\x01\x01":
                times = data[at - 1] << shift
                if not line or len(line) + 4 * times > 4 * count:
                    raise IndexError("a run beyond its line")
                line += line[-4:] * times
                shift += 8
            elif len(texel) < 4:
                break
            else:
                line += texel
                shift = 0
    if len(line) != 4 * count:
        raise IndexError("a line that ends early")
    return np.frombuffer(line, np.uint8).reshape(count, 4).T, at


def _seen(colors, said):
    """(colours, notes) as a Radiance header says that they are to be taken."""
    notes = []
    exposure = math.prod(float(text) for text in said.get("EXPOSURE", ()))
    if exposure != 1.0:
        if not 0.0 < exposure < math.inf:
            raise ValueError("no exposure")
        colors /= np.float32(exposure)
        notes.append(f"divided by its EXPOSURE of {exposure:g}")
    form = next(iter(said.get("FORMAT", ())), _RGBE)
    primaries = [[float(word) for word in text.split()] for text in said.get("PRIMARIES", ())]
    # White stays white, as Radiance's ra_xyze keeps it.
    if form == _XYZE:
        matrix, what = _times(_inverse(_to_xyz(_REC_709)), _adapted(_RADIANCE[6:])), "XYZ"
    elif primaries and primaries[-1] != list(_RADIANCE):
        matrix, what = np.eye(3), "its PRIMARIES"
        matrix = _times(_inverse(_to_xyz(_REC_709)), _adapted(primaries[-1][6:]))
        matrix = _times(matrix, _to_xyz(primaries[-1]))
    else:
        return colors, tuple(notes)
    return _converted(colors, matrix), (*notes, f"colours made Rec. 709's from {what}")


# ------------------------------------------------------------------------------------------------- OpenEXR


def openexr(path):
    """(float32 or float16 [rows, columns, 1 or 3], notes) of an OpenEXR file: of its first part that has red,
    green and blue, or else luminance, over its display window. Raises Refusal.
    """
    try:
        import OpenImageIO as oiio  # noqa: N813
    except ImportError:
        raise Refusal(
            f"{path} is an OpenEXR file, which needs the extra `probes`: pip install 'fixedpipe[probes]'."
        ) from None
    damaged = "begins as an OpenEXR file and cannot be read to its end: it is cut off or damaged"
    with whole(path, damaged, _SAVE_AGAIN), silent():
        file = oiio.ImageInput.open(str(path))
        if file is None:
            error = oiio.geterror()
            if "ubsampled" in error:
                return _luminance_and_chroma(path)
            raise _unread(path, error)
        try:
            return _first_colors(path, file, oiio)
        finally:
            file.geterror()  # said by now; the library would print it at the end
            file.close()


def _unread(path, error):
    return Refusal(
        f"{path} begins as an OpenEXR file and cannot be read to its end: {one_line(error, path)}. "
        f"{_SAVE_AGAIN}"
    )


def _first_colors(path, file, oiio):
    seen = []
    for wanted in (_colors_of, _luminance_of):
        part = 0
        while file.seek_subimage(part, 0):
            spec = file.spec()
            channels = None if spec.deep else wanted(list(spec.channelnames))
            if channels:
                return _part(path, file, part, channels, oiio)
            seen += spec.channelnames if wanted is _colors_of else ()
            part += 1
    raise Refusal(
        f"{path} has the channels {', '.join(map(repr, seen[:20]))}; give a file with R, G and B, or Y."
    )


def _colors_of(names):
    """Numbers of a part's channels R, G and B, or those of its first layer that has all three."""
    at = {name.lower(): k for k, name in reversed(list(enumerate(names)))}
    layers = dict.fromkeys(name.rpartition(".")[0] for name in at)
    for layer in sorted(layers, key=bool):  # that without a name first
        before = f"{layer}." if layer else ""
        for three in (("r", "g", "b"), ("red", "green", "blue")):
            if all(before + color in at for color in three):
                return [at[before + color] for color in three]
    return None


def _luminance_of(names):
    return [names.index("Y")] if "Y" in names else None


def _part(path, file, part, channels, oiio):
    """(colours, notes) of a part's channels by their numbers."""
    spec = file.spec()
    display = spec.full_width, spec.full_height
    check_count(path, display, "pixels", PIXELS)
    check_count(f"The data window of {path}", (spec.width, spec.height), "pixels", PIXELS)
    check_count(f"A tile of {path}", (spec.tile_width, spec.tile_height), "pixels", PIXELS)
    kind = np.float16 if all(str(spec.channelformat(k)) == "half" for k in channels) else np.float32
    values = np.empty((spec.height, spec.width, len(channels)), kind)
    form = oiio.HALF if kind is np.float16 else oiio.FLOAT
    for k, channel in enumerate(channels):
        read = file.read_image(part, 0, channel, channel + 1, form)
        if read is None:
            raise _unread(path, file.geterror())
        values[..., k] = np.asarray(read).reshape(spec.height, spec.width)
    notes = []
    name = spec.get_string_attribute("oiio:subimagename")
    if part:
        notes.append(f"of its part {part + 1}{f', {name}' if name else ''}")
    at = spec.x - spec.full_x, spec.y - spec.full_y
    values, said = _shown(values, at, display)
    chromaticities = spec.getattribute("chromaticities")
    return _of_709(values, chromaticities, (*notes, *said))


def _shown(values, at, display):
    """(values over a display window, notes): ``at``, where the data window begins in it, columns and rows."""
    rows, columns = values.shape[:2]
    if at == (0, 0) and (columns, rows) == display:
        return values, ()
    out = np.zeros((display[1], display[0], values.shape[2]), values.dtype)
    left, top = (max(k, 0) for k in at)
    right, bottom = max(min(at[0] + columns, display[0]), left), max(min(at[1] + rows, display[1]), top)
    out[top:bottom, left:right] = values[top - at[1] : bottom - at[1], left - at[0] : right - at[0]]
    return out, (f"data of {columns} x {rows} in a window of {display[0]} x {display[1]}",)


def _of_709(values, chromaticities, notes):
    """(values, notes) of a file whose chromaticities are not Rec. 709's, colorimetrically."""
    if chromaticities is None or values.shape[2] < 3 or np.allclose(chromaticities, _REC_709, atol=1e-3):
        return values, notes
    matrix = _times(_inverse(_to_xyz(_REC_709)), _to_xyz(chromaticities))
    said = "colours made Rec. 709's from its chromaticities"
    return _converted(values.astype(np.float32), matrix), (*notes, said)


def _luminance_and_chroma(path):
    """(colours, notes) of a file of Y, RY and BY, where chroma has half as many rows and columns."""
    try:
        import OpenEXR
    except ImportError:
        raise Refusal(
            f"{path} has luminance and chroma, which need the extra `probes`: pip install "
            "'fixedpipe[probes]'."
        ) from None
    parts = OpenEXR.File(str(path), header_only=True).parts
    headers = [part.header for part in parts]
    total = 0
    for header in headers:
        low, high = (np.asarray(corner, np.int64) for corner in header["dataWindow"])
        size = tuple((high - low + 1).tolist())
        check_count(path, size, "pixels", PIXELS)
        total += math.prod(size) * len(header["channels"])
    check_count(path, (total,), "values of its channels", 4 * PIXELS)
    with redirect_stdout(io.StringIO()):  # where the library says that it leaves a part out
        file = OpenEXR.File(str(path), separate_channels=True)
    if len(file.parts) < len(headers):
        raise ValueError("a part is damaged")
    for part in file.parts:
        if "Y" not in part.channels:
            continue
        header = part.header
        low, high = (np.asarray(corner, np.int64) for corner in header["dataWindow"])
        begin, end = (np.asarray(corner, np.int64) for corner in header["displayWindow"])
        display = tuple((end - begin + 1).tolist())
        check_count(path, display, "pixels", PIXELS)
        values = _rgb(part.channels, header.get("chromaticities"))
        values, notes = _shown(values, tuple((low - begin).tolist()), display)
        return _of_709(values, header.get("chromaticities"), (*notes, "of luminance and chroma"))
    raise Refusal(f"{path} has neither R, G and B nor Y; give a file that has.")


def _rgb(channels, chromaticities):
    """Red, green and blue of Y, RY = (R - Y) / Y and BY, linear between those of chroma: float32."""
    luminance = np.asarray(channels["Y"].pixels, np.float32)
    weights = _to_xyz(_REC_709 if chromaticities is None else chromaticities)[1]
    if not {"RY", "BY"} <= channels.keys():
        return luminance[..., None]
    red, blue = (
        luminance * (1.0 + _finer(np.asarray(channels[name].pixels, np.float32), luminance.shape))
        for name in ("RY", "BY")
    )
    green = (luminance - np.float32(weights[0]) * red - np.float32(weights[2]) * blue) / np.float32(
        weights[1]
    )
    return np.stack([red, green, blue], axis=-1)


def _finer(chroma, shape):
    """Chroma at every row and column: what is given is at those of even numbers."""
    for axis, wanted in enumerate(shape):
        if chroma.shape[axis] != wanted:
            at = np.minimum(np.arange(wanted) / 2.0, chroma.shape[axis] - 1.0)
            low = at.astype(np.int64)
            high = np.minimum(low + 1, chroma.shape[axis] - 1)
            share = (at - low).astype(np.float32).reshape((-1, 1) if axis == 0 else (1, -1))
            chroma = chroma.take(low, axis) * (1.0 - share) + chroma.take(high, axis) * share
    return chroma
