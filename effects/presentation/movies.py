"""Animations as files, written frame by frame: lossless APNG and WebP, and MP4 for programs without them.

The frames of APNG and WebP are single pictures of those formats, in a container that this module writes. It
holds no more than one frame at a time, and equal frames stay separate. A frame's time is exact in APNG, and
in WebP exact to a millisecond; so is the total.
"""

import io
import struct
import zlib

import numpy as np
from PIL import Image

from fixedpipe.effects.refusal import Refusal

# Assumed: constant rate factor of H.264: artefacts are not seen, and files are a tenth as large as lossless.
_QUALITY = "14"


def _chunk(name, data):
    """A chunk of PNG."""
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _chunks_of(png):
    """(name, data) of the chunks of a PNG file."""
    place = 8
    while place < len(png):
        (length,) = struct.unpack_from(">I", png, place)
        yield png[place + 4 : place + 8], png[place + 8 : place + 8 + length]
        place += 12 + length


def _still(frame, kind, **settings):
    """A frame as the bytes of a picture by itself."""
    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(frame)).save(buffer, kind, **settings)
    return buffer.getvalue()


def _write_apng(path, frames, count, rate, loop):
    # Source: PNG specification, third edition, sections 11.3.6 (animation) and 13 (order of chunks).
    with open(path, "wb") as file:
        number = 0
        for n, frame in enumerate(frames):
            height, width = frame.shape[:2]
            chunks = list(_chunks_of(_still(frame, "PNG")))
            if n == 0:
                file.write(b"\x89PNG\r\n\x1a\n" + _chunk(*chunks[0]))
                file.write(_chunk(b"acTL", struct.pack(">II", count, 0 if loop else 1)))
            control = struct.pack(">IIIIIHHBB", number, width, height, 0, 0, 1, rate, 0, 0)
            file.write(_chunk(b"fcTL", control))
            number += 1
            for data in (data for name, data in chunks if name == b"IDAT"):
                if n == 0:
                    file.write(_chunk(b"IDAT", data))
                else:
                    file.write(_chunk(b"fdAT", struct.pack(">I", number) + data))
                    number += 1
        file.write(_chunk(b"IEND", b""))
        if number and n + 1 != count:  # fewer frames came than were announced
            file.seek(33)  # after the signature and IHDR
            file.write(_chunk(b"acTL", struct.pack(">II", n + 1, 0 if loop else 1)))


def _riff(name, data):
    """A chunk of RIFF: its length is even in the file."""
    return name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2)


def _write_webp(path, frames, count, rate, loop):
    # Source: WebP Container Specification, "Animation"; RFC 9649, section 2.7.
    animated, not_blended = 0x02, 0x02
    with open(path, "wb") as file:
        for n, frame in enumerate(frames):
            height, width = frame.shape[:2]
            size = struct.pack("<I", width - 1)[:3] + struct.pack("<I", height - 1)[:3]
            if n == 0:
                file.write(b"RIFF\0\0\0\0WEBP" + _riff(b"VP8X", bytes((animated, 0, 0, 0)) + size))
                file.write(_riff(b"ANIM", struct.pack("<IH", 0, 0 if loop else 1)))
            still = _still(frame, "WEBP", lossless=True, exact=True, method=4)
            lasts = round(1000 * (n + 1) / rate) - round(1000 * n / rate)
            head = bytes(6) + size + struct.pack("<I", lasts)[:3] + bytes((not_blended,))
            file.write(_riff(b"ANMF", head + still[12:]))
        length = file.tell()
        file.seek(4)
        file.write(struct.pack("<I", length - 8))


def _write_mp4(path, frames, count, rate, loop):
    import imageio.v2 as imageio

    frames = iter(frames)
    first = next(frames)
    check_edges(path, *first.shape[1::-1])
    with imageio.get_writer(
        path, format="FFMPEG", mode="I", fps=rate, codec="libx264", pixelformat="yuv420p",
        macro_block_size=2, quality=None,
        output_params=["-crf", _QUALITY, "-fflags", "+bitexact", "-movflags", "+faststart"],
    ) as writer:  # fmt: skip
        writer.append_data(first)
        for frame in frames:
            writer.append_data(frame)


def _video_library():
    """Raise Refusal where imageio-ffmpeg is not installed."""
    try:
        import imageio_ffmpeg  # noqa: F401 (imageio finds it)
    except ImportError as error:
        raise Refusal(
            "MP4 needs imageio-ffmpeg, which is not installed: pip install 'fixedpipe[video]'. APNG and WebP "
            "need nothing more, and are lossless."
        ) from error


# By the ending of a file's name: who writes it, and what it is.
KINDS = {
    ".png": (_write_apng, "APNG, lossless"),
    ".apng": (_write_apng, "APNG, lossless"),
    ".webp": (_write_webp, "WebP, lossless"),
    ".mp4": (_write_mp4, "MP4, H.264 with halved colours: lossy"),
}


def kind_of(path):
    """(the writer of a file of that name, the file's kind).

    Raises Refusal for another ending, and for MP4 if imageio-ffmpeg is not installed.
    """
    ending = path.suffix.lower()
    if ending not in KINDS:
        raise Refusal(f"The name {path} must end with one of {', '.join(KINDS)}.")
    if ending == ".mp4":
        _video_library()
    return KINDS[ending]


def check_edges(path, width, height):
    """Raise Refusal if a file of that name cannot have frames of so many pixels."""
    if path.suffix.lower() == ".mp4" and (width % 2 or height % 2):
        raise Refusal(
            f"MP4 halves the edges of what holds its colours, and {width}x{height} pixels are odd; give an "
            "even --size."
        )


def check_rate(rate):
    """Raise Refusal for frames a second that no player shows."""
    if not 1 <= rate <= 60:
        raise Refusal(f"The rate is {rate} frames a second; give 1 to 60.")


def write_animation(path, frames, count, rate, loop=True):
    """Write an animation, by the ending of its name.

    path    a Path that ends in one of KINDS
    frames  uint8 [h, w, 3] each, of one shape, top row first; asked for one after the other
    count   how many there are
    rate    frames a second, 1 to 60
    loop    whether players begin again at the end; MP4 cannot store this

    Raises Refusal as ``kind_of`` does, for MP4 of an odd width or height, and for a rate out of range.
    """
    check_rate(rate)
    write, _ = kind_of(path)
    write(path, frames, count, rate, loop)
