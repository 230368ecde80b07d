"""DirectDraw surface files of S3TC textures, as the programs' resources hold them.

Source: the public description of the DDS header: height and width at bytes 12 and 16, the number of levels at
28, the format's four letters at 84, the blocks of all levels from 128 on.
"""

import struct

from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.words import compressed_texture


def read_texture(path, mipmaps=True):
    """The 2D texture of a DDS file, all its levels or the first. Raises ValueError for other files."""
    data = path.read_bytes()
    letters = data[84:88].decode("latin-1")
    formats = {f"DXT{n}": InternalFormat[f"COMPRESSED_RGBA_S3TC_DXT{n}"] for n in (1, 3, 5)}
    if data[:4] != b"DDS " or letters not in formats:
        raise ValueError(f"{path} is no DDS file of a DXT1, DXT3 or DXT5 texture.")
    height, width = struct.unpack_from("<II", data, 12)
    levels = max(1, struct.unpack_from("<I", data, 28)[0]) if mipmaps else 1
    return compressed_texture(data[128:], formats[letters], width, height, levels)
