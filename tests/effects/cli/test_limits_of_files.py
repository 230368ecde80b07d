"""Files that say, or unpack to, more than they are: refused before memory is taken, in a process that has
1.5 GB of it.
"""

import bz2
import io
import json
import resource
import struct
import subprocess
import sys
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest

from tests.effects.cli.test_cli import refusal_of
from tests.support import user_files

ROOT = Path(__file__).parents[3]
MOST = 1_500_000_000
ZEROS = bytes(1 << 26)
NRRD = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: %s\nencoding: %s\n\n"
# Reads each file that is named, and prints what came of it and the most memory that the process had.
READ = """
import json, sys
from pathlib import Path
from fixedpipe.effects.user_pictures import factored_brdf, maps, probes, volume_files
from fixedpipe.effects.refusal import Refusal
from tests.support.memory import largest_memory

def of_heights(name):
    return maps.height_field(name).fitted(64, 64, 0.1, repeated=True)

def of_colors(name):
    return maps.photograph(name).fitted(64, 64, repeated=True)

def of_probe(name):
    return probes.maps(probes.probe(name), "cube", 64)

def of_volume(name):
    return volume_files.read_nrrd(Path(name))

readers = {"heights": of_heights, "colors": of_colors, "probe": of_probe, "volume": of_volume,
           "brdf": factored_brdf.read}
said = {}
for pair in sys.argv[1:]:
    kind, name = pair.split("=", 1)
    try:
        readers[kind](name)
        said[Path(name).name] = None
    except Refusal as refused:
        said[Path(name).name] = str(refused)
print(json.dumps([said, largest_memory()]))
"""


def read(*pairs):
    """({file's name: sentence of its refusal, or None}, bytes) of readers' names and paths."""
    arguments = [f"{kind}={path}" for kind, path in pairs]
    done = subprocess.run(
        [sys.executable, "-c", READ, *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (MOST, MOST)),
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def deflated(times, wrapped=False):
    """A deflate stream of so many times 64 MiB of zeros; ``wrapped``: with the header of zlib."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    piece = packer.compress(ZEROS) + packer.flush(zlib.Z_FULL_FLUSH)
    return (b"\x78\x9c" if wrapped else b"") + piece * times + zlib.compressobj(9, zlib.DEFLATED, -15).flush()


def zipped(name, data, size, method=8):
    """A ZIP file of one member, deflated or by another method, which says that it has so many bytes."""
    local = (
        struct.pack("<4sHHHHHIIIHH", b"PK\3\4", 20, 0, method, 0, 0, 0, len(data), size, len(name), 0) + name
    )
    central = struct.pack(
        "<4sHHHHHHIIIHHHHHII",
        b"PK\1\2",
        20,
        20,
        0,
        method,
        0,
        0,
        0,
        len(data),
        size,
        len(name),
        0,
        0,
        0,
        0,
        0,
        0,
    )
    end = struct.pack(
        "<4sHHHHIIH", b"PK\5\6", 0, 0, 1, 1, len(central) + len(name), len(local) + len(data), 0
    )
    return local + data + central + name + end


def npy_header(shape, dtype="<f8"):
    """The first bytes of an NPY file."""
    data = io.BytesIO()
    np.lib.format.write_array_header_1_0(data, {"shape": shape, "fortran_order": False, "descr": dtype})
    return data.getvalue()


def stored(data):
    """A deflate stream of bytes as they are, to be gone on with."""
    packer = zlib.compressobj(0, zlib.DEFLATED, -15)
    return packer.compress(data) + packer.flush(zlib.Z_FULL_FLUSH)


def png_header(columns, rows, bits, color):
    chunk = struct.pack(">IIBBBBB", columns, rows, bits, color, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + b"IHDR" + chunk
    return data + struct.pack(">I", zlib.crc32(b"IHDR" + chunk))


def huge_tile():
    """A TIFF file of 8 x 8 pixels in one tile of 60000 x 60000."""
    tags = [(tag, 4, 1, struct.pack("<I", 60000)) for tag in (322, 323)]
    return user_files.tiff(np.zeros((8, 8), np.uint16), tags=tags)


def of_many_values():
    """A TIFF file of 8 x 8 whole numbers of 64 bits, whose strip unpacks to 2 GiB."""
    packed = deflated(32, wrapped=True)
    made = user_files.tiff(np.zeros((8, 8), np.int64), compression=8)
    before = struct.unpack("<I", made[4:8])[0]
    data = bytearray(made)
    count = struct.unpack("<H", data[before : before + 2])[0]
    for k in range(count):
        at = before + 2 + 12 * k
        tag = struct.unpack("<H", data[at : at + 2])[0]
        if tag in (273, 279):
            data[at + 8 : at + 12] = struct.pack("<I", len(made) if tag == 273 else len(packed))
    return bytes(data) + packed


BRDF = (4, 4, 4, 4, 3)
BOMBS = {
    "many.nrrd": ("volume", lambda: NRRD % (b"24 24 24", b"bzip2") + bz2.compress(ZEROS) * 32, "more values"),
    "more.nrrd": (
        "volume",
        lambda: NRRD % (b"24 24 24", b"gzip") + _gzip(deflated(64), 64 * len(ZEROS)),
        "more values than it names",
    ),
    "large.nrrd": ("volume", lambda: NRRD % (b"2048 2048 1024", b"gzip"), "4294.967296 million"),
    "members.npz": (
        "brdf",
        lambda: zipped(b"samples.npy", stored(npy_header(BRDF) + bytes(6144)) + deflated(32), 2**31),
        "more values than",
    ),
    "grid.npz": (
        "brdf",
        lambda: zipped(b"samples.npy", stored(npy_header((110, 110, 110, 110, 3))) + deflated(1), 2**32 - 1),
        "146.41 million",
    ),
    "bzip2.npz": (
        "brdf",
        lambda: zipped(b"samples.npy", bz2.compress(npy_header(BRDF)) + bz2.compress(ZEROS) * 32, 2**31, 12),
        "packed by method 12",
    ),
    "method.npz": ("brdf", lambda: zipped(b"samples.npy", b"", 9, 99), "packed by method 99"),
    "large.png": ("heights", lambda: png_header(13000, 13000, 8, 2), "169 million"),
    "deep.png": ("heights", lambda: png_header(13000, 13000, 16, 6), "169 million"),
    "large.tif": ("heights", lambda: _large_tiff(), "3600 million"),
    "tile.tif": ("heights", huge_tile, "A tile of"),
    "strip.tif": ("heights", of_many_values, "more values than it names"),
    "large.npy": ("heights", lambda: npy_header((100000, 100000)), "10000 million"),
    "large.pgm": ("heights", lambda: b"P5 60000 60000 255\n", "3600 million"),
    "large.asc": ("heights", lambda: b"ncols 60000\nnrows 60000\n1 2 3", "3600 million"),
    "large.hdr": ("probe", lambda: b"#?RADIANCE\n\n-Y 60000 +X 120000\n\2\2\0\0", "7200 million"),
    "run.hdr": ("probe", lambda: b"#?RADIANCE\n\n-Y 2 +X 4\n" + b"\1\2\3\4" + b"\1\1\1\xff" * 40, "cut off"),
}


def _gzip(stream, size):
    return b"\x1f\x8b\x08\0\0\0\0\0\0\xff" + stream + struct.pack("<II", 0, size & 0xFFFFFFFF)


def _large_tiff():
    tags = [(tag, 4, 1, struct.pack("<I", 60000)) for tag in (256, 257)]
    return user_files.tiff(np.zeros((8, 8), np.uint16), tags=tags)


def test_what_says_or_unpacks_to_too_much_is_refused_before_it_takes_memory(tmp_path):
    for library in ("nrrd", "OpenImageIO", "tifffile"):
        pytest.importorskip(library)
    for name, (_, made, _) in BOMBS.items():
        (tmp_path / name).write_bytes(made())
    windows = {"full_width": 60000, "full_height": 30000}
    bombs = BOMBS | {"window.exr": ("probe", None, "1800 million")}
    channels = {name: np.zeros((8, 16)) for name in "RGB"}
    (tmp_path / "window.exr").write_bytes(user_files.of_exr(tmp_path, channels, **windows))
    said, most = read(*((kind, tmp_path / name) for name, (kind, _, _) in bombs.items()))
    for name, (_, _, words) in bombs.items():
        assert said[name] and words in said[name], (name, said[name])
    assert most < 400_000_000


def _largest_png(path, columns, rows):
    line = b"\0" + bytes(range(256)) * (3 * columns // 256 + 1)
    packer = zlib.compressobj(1)
    data = packer.compress(line[: 1 + 3 * columns])
    for _ in range(rows - 1):
        data += packer.compress(bytes(1 + 3 * columns))
    data += packer.flush()
    end = b"IDAT" + data
    whole = png_header(columns, rows, 8, 2) + struct.pack(">I", len(data)) + end
    path.write_bytes(whole + struct.pack(">I", zlib.crc32(end)) + bytes(4) + b"IEND\xaeB`\x82")


@pytest.mark.parametrize("kind", ["heights", "colors", "probe", "npz"])
def test_the_largest_that_is_read_takes_less_than_the_memory_that_is_said(tmp_path, kind):
    path = tmp_path / f"large.{'npz' if kind == 'npz' else 'png'}"
    if kind == "npz":
        with (
            zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file,
            file.open("samples.npy", "w", force_zip64=True) as member,
        ):
            member.write(npy_header((64, 64, 64, 64, 3)))
            for _ in range(5):
                member.write(ZEROS)
            member.write(ZEROS[:-8] + struct.pack("<d", 1.0))  # one that is all zero is refused
    else:
        _largest_png(path, 8944, 4472)
    said, most = read(("brdf" if kind == "npz" else kind, path))
    assert said == {path.name: None}
    assert most < MOST


def test_the_limit_is_the_users(tmp_path):
    path, out = tmp_path / "large.png", tmp_path / "out.npz"
    path.write_bytes(png_header(13000, 13000, 8, 2))
    refused = refusal_of("roughness", path, "--out", out)
    assert "13000 x 13000 pixels, 169 million; up to 40 million are read" in refused
    assert refused.endswith("--limit 169.")
    assert "up to 168 million" in refusal_of("roughness", path, "--out", out, "--limit", 168)
    assert "cannot be read to its end" in refusal_of("roughness", path, "--out", out, "--limit", 169)
