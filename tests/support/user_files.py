"""Small files of every kind that users bring, each with its reader."""

import io
import struct
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

from fixedpipe.effects.scattering import merl
from fixedpipe.effects.user_pictures import factored_brdf
from fixedpipe.effects.user_pictures.inputs import read_mesh, read_picture
from fixedpipe.effects.user_pictures.probes import probe
from fixedpipe.effects.user_pictures.volume_files import read_nrrd

HEIGHTS = np.arange(48.0).reshape(6, 8) % 7
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0.25]])
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
"""
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
NRRD = b"NRRD0004\ntype: short\ndimension: 3\nsizes: 4 3 2\nencoding: %s\nendian: little\nspacings: 1 1 2\n\n"


def of_picture(kind, **more):
    """A picture of bytes by Pillow."""
    data = io.BytesIO()
    Image.fromarray((HEIGHTS * 36).astype(np.uint8)).save(data, kind, **more)
    return data.getvalue()


def of_array(array=HEIGHTS):
    """An NPY file."""
    data = io.BytesIO()
    np.save(data, array)
    return data.getvalue()


def of_samples(samples):
    """An NPZ file of a BRDF."""
    data = io.BytesIO()
    np.savez_compressed(data, samples=samples)
    return data.getvalue()


def of_ply(binary):
    """A PLY file of two triangles."""
    if not binary:
        lines = [" ".join(map(str, c)) for c in CORNERS] + [f"3 {a} {b} {c}" for a, b, c in TRIANGLES]
        return (PLY + "\n".join(lines) + "\n").encode()
    faces = np.array([(3, t) for t in TRIANGLES], [("count", "u1"), ("corners", "<i4", 3)])
    data = CORNERS.astype("<f4").tobytes() + faces.tobytes()
    return PLY.replace("ascii", "binary_little_endian").encode() + data


def of_nrrd(encoding):
    """An NRRD file of 24 values."""
    import bz2
    import gzip

    values = np.arange(24, dtype="<i2")
    text = " ".join(map(str, values)).encode()
    data = {
        "raw": values.tobytes(),
        "ascii": text,
        "gzip": gzip.compress(values.tobytes(), mtime=0),
        "bzip2": bz2.compress(values.tobytes()),
    }
    return NRRD % encoding.encode() + data[encoding]


def of_png(values):
    """A PNG file of 16 bits a component: uint16 [rows, columns, components]."""
    rows, columns, components = values.shape
    color = {1: 0, 2: 4, 3: 2, 4: 6}[components]
    lines = b"".join(b"\0" + row.astype(">u2").tobytes() for row in values)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", columns, rows, 16, color, 0, 0, 0)),
        (b"IDAT", zlib.compress(lines)),
        (b"IEND", b""),
    )
    data = b"\x89PNG\r\n\x1a\n"
    for kind, chunk in chunks:
        data += struct.pack(">I", len(chunk)) + kind + chunk + struct.pack(">I", zlib.crc32(kind + chunk))
    return data


def tiff(values, *, tags=(), compression=1, order="<", big=False):
    """A TIFF file of one strip: [rows, columns(, components)] of any type; ``tags``: (number, type, count,
    bytes of the value) more.
    """
    rows, columns = values.shape[:2]
    components = values.shape[2] if values.ndim == 3 else 1
    data = values.astype(values.dtype.newbyteorder(order)).tobytes()
    data = zlib.compress(data) if compression == 8 else data
    form = {"u": 1, "i": 2, "f": 3}[values.dtype.kind]
    bits = np.full(components, 8 * values.dtype.itemsize, f"{order}u2").tobytes()
    whole = f"{order}Q" if big else f"{order}I"
    room = struct.calcsize(whole)

    def number(value):
        return struct.pack(whole, value)

    kind = 16 if big else 4
    photometric = 2 if components >= 3 else 1
    entries = [
        (256, kind, 1, number(columns)), (257, kind, 1, number(rows)), (258, 3, components, bits),
        (259, kind, 1, number(compression)), (262, kind, 1, number(photometric)), (273, kind, 1, None),
        (277, kind, 1, number(components)), (278, kind, 1, number(rows)), (279, kind, 1, number(len(data))),
        (339, 3, components, np.full(components, form, f"{order}u2").tobytes()),
    ]  # fmt: skip
    if components in (2, 4):
        entries.append((338, 3, 1, struct.pack(f"{order}H", 2)))
    given = {tag[0] for tag in tags}
    entries = sorted([*(entry for entry in entries if entry[0] not in given), *tags], key=lambda e: e[0])
    header = (b"II" if order == "<" else b"MM") + struct.pack(f"{order}H", 43 if big else 42)
    header += struct.pack(f"{order}HHQ", 8, 0, 16) if big else number(8)
    count = struct.pack(f"{order}Q" if big else f"{order}H", len(entries))
    after = len(header) + len(count) + len(entries) * (4 + 2 * room) + room
    places, extra = b"", b""
    for tag, type_, many, value in entries:
        value = number(after) if value is None else value
        if len(value) > room:
            places += (
                struct.pack(f"{order}HH", tag, type_) + number(many) + number(after + len(data) + len(extra))
            )
            extra += value
        else:
            places += struct.pack(f"{order}HH", tag, type_) + number(many) + value.ljust(room, b"\0")
    return header + count + places + number(0) + data + extra


def of_radiance(texels, orientation="-Y {rows} +X {columns}", lines=("FORMAT=32-bit_rle_rgbe",), coded=True):
    """A Radiance picture of RGBE texels, uint8 [lines, texels, 4]; ``coded``: by runs of components."""
    rows, columns = texels.shape[:2]
    head = "\n".join(("#?RADIANCE", *lines, "", orientation.format(rows=rows, columns=columns), "")).encode()
    if not coded:
        return head + texels.tobytes()
    for line in texels:
        head += b"\x02\x02" + struct.pack(">H", columns)
        for component in line.T:
            for first in range(0, columns, 128):
                some = component[first : first + 128]
                head += bytes([len(some)]) + some.tobytes()
    return head


def texels(rows=8, columns=16):
    """RGBE of a sky, bottom dark, with one bright texel: uint8 [rows, columns, 4]."""
    out = np.full((rows, columns, 4), 128, np.uint8)
    out[..., 0] = 16 * np.arange(rows)[:, None] + np.arange(columns)
    out[..., 1] = 200 - 8 * np.arange(rows)[:, None]
    out[1, 3 % columns] = (200, 190, 180, 131)
    return out


def of_exr(folder, channels, **attributes):
    """An OpenEXR file by OpenImageIO: {name: float32 [rows, columns]}; attributes of its ImageSpec."""
    import OpenImageIO as oiio  # noqa: N813

    values = np.stack(list(channels.values()), axis=-1).astype(np.float32)
    rows, columns = values.shape[:2]
    spec = oiio.ImageSpec(columns, rows, len(channels), "half")
    spec.channelnames = tuple(channels)
    for name, value in attributes.items():
        if name == "chromaticities":
            spec.attribute(name, oiio.TypeDesc("float[8]"), value)
        else:
            setattr(spec, name, value)
    path = Path(folder) / "made.exr"
    out = oiio.ImageOutput.create(str(path))
    assert out.open(str(path), spec), out.geterror()
    out.write_image(np.ascontiguousarray(values))
    out.close()
    return path.read_bytes()


def of_luminance_and_chroma(luminance, red, blue):
    """An OpenEXR file of halves, not compressed: Y, and RY and BY at every second line and column."""
    rows, columns = luminance.shape
    channels = b"".join(
        name + b"\0" + struct.pack("<iIii", 1, 0, step, step)
        for name, step in ((b"BY", 2), (b"RY", 2), (b"Y", 1))
    )
    window = struct.pack("<4i", 0, 0, columns - 1, rows - 1)
    attributes = (
        (b"channels", b"chlist", channels + b"\0"),
        (b"compression", b"compression", b"\0"),
        (b"dataWindow", b"box2i", window),
        (b"displayWindow", b"box2i", window),
        (b"lineOrder", b"lineOrder", b"\0"),
        (b"pixelAspectRatio", b"float", struct.pack("<f", 1.0)),
        (b"screenWindowCenter", b"v2f", bytes(8)),
        (b"screenWindowWidth", b"float", struct.pack("<f", 1.0)),
    )
    data = b"\x76\x2f\x31\x01" + struct.pack("<I", 2)
    for name, kind, value in attributes:
        data += name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value
    data += b"\0"
    places, lines = b"", b""
    for line in range(rows):
        even = () if line % 2 else (blue[line // 2], red[line // 2])
        values = np.concatenate([*even, luminance[line]]).astype("<f2").tobytes()
        places += struct.pack("<Q", len(data) + 8 * rows + len(lines))
        lines += struct.pack("<iI", line, len(values)) + values
    return data + places + lines


def _nrrd(name):
    return read_nrrd(Path(name))


def files(folder):
    """{file's name: (bytes, reader)} of every kind; ``folder``: for what a library writes."""
    deep = (100 * HEIGHTS).astype(np.uint16)
    colors = np.stack([deep, deep + 1, deep + 2], axis=-1)
    numbers = b"".join(b"%d " % n for n in range(48))
    panorama = {name: np.linspace(0.0, 2.0, 128).reshape(8, 16) for name in "RGB"}
    chroma = np.full((4, 8), 0.1)
    return {
        "a.png": (of_picture("PNG"), read_picture),
        "deep.png": (of_png(colors), read_picture),
        "a.tiff": (of_picture("TIFF"), read_picture),
        "deep.tiff": (tiff(colors), read_picture),
        "whole.tiff": (tiff(deep.astype(np.int64), compression=8), read_picture),
        "a.jpg": (of_picture("JPEG"), read_picture),
        "a.npy": (of_array(), read_picture),
        "a.asc": (b"ncols 8\nnrows 6\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + numbers, read_picture),
        "a.pgm": (b"P5\n# hills\n8 6\n65535\n" + deep.astype(">u2").tobytes(), read_picture),
        "text.ply": (of_ply(False), read_mesh),
        "binary.ply": (of_ply(True), read_mesh),
        "a.obj": (OBJ.encode(), read_mesh),
        "raw.nrrd": (of_nrrd("raw"), _nrrd),
        "text.nrrd": (of_nrrd("ascii"), _nrrd),
        "gzip.nrrd": (of_nrrd("gzip"), _nrrd),
        "bzip2.nrrd": (of_nrrd("bzip2"), _nrrd),
        "a.hdr": (of_radiance(texels()), probe),
        "old.hdr": (of_radiance(texels(), lines=(), coded=False), probe),
        "a.exr": (of_exr(folder, panorama), probe),
        "chroma.exr": (of_luminance_and_chroma(panorama["R"], chroma, -chroma), probe),
        "a.npz": (of_samples(np.arange(48.0).reshape(2, 2, 2, 2, 3)), factored_brdf.read),
        "a.binary": (
            b"".join((np.array([90, 90, 180], "<i4").tobytes(), bytes(merl.BYTES - 12))),
            factored_brdf.read,
        ),
    }
