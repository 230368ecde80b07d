"""An extension for tests with syrupy snapshots: PNG files, compared by the digest of their pixels.

    from fixedpipe.pipeline.golden.syrupy_extension import GoldenSnapshotExtension

    def test_lit(snapshot):
        assert snapshot(extension_class=GoldenSnapshotExtension) == picture

The snapshot stands on the left, because a NumPy array there would compare each of its components with it.
fixedpipe does not require syrupy, so the class is created at first use.
"""

from functools import cache
from typing import Any

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.differences import difference, kinds_differ
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.pixels import pixels_of, pixels_of_png

_NAME = "GoldenSnapshotExtension"


def __getattr__(name: str) -> Any:
    """The extension's class. Raises ImportError where syrupy is not installed."""
    if name == _NAME:
        return _extension()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@cache
def _extension():
    try:
        from syrupy.extensions.single_file import SingleFileSnapshotExtension
    except ModuleNotFoundError as error:
        raise ImportError(f"{_NAME} is an extension of syrupy, which is not installed here.") from error

    class GoldenSnapshotExtension(SingleFileSnapshotExtension):
        """Snapshots of pictures that ``pixels_of`` takes, kept as PNG files with all their bits."""

        # Syrupy before version 5 uses the second name.
        file_extension = _file_extension = "png"

        def serialize(self, data, **_):
            """The PNG file of a picture. Raises ValueError for a value that is no picture."""
            return whole_png(pixels_of(data))

        def matches(self, *, serialized_data, snapshot_data):
            """Whether both files hold the same pixels, from any writer."""
            return digest(pixels_of_png(serialized_data)) == digest(pixels_of_png(snapshot_data))

        def diff_lines(self, serialized_data, snapshot_data):
            """A line on how the pixels differ."""
            was, now = pixels_of_png(snapshot_data), pixels_of_png(serialized_data)
            yield kinds_differ(was, now) or str(difference(was, now))

    return GoldenSnapshotExtension
