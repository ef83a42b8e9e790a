"""Film files: GIF, animated PNG and WebP written by Pillow, MP4 by ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.errors import InputError, MissingPackageError
from linkwork.foundation.optional_packages import installed_with

if TYPE_CHECKING:
    from PIL.Image import Image

__all__ = ["FILM_FORMATS", "check_film", "film_bytes"]

#: Formats by suffix.
FILM_FORMATS = ("gif", "mp4", "apng", "webp")

_COLOURS = 96  # colours of a GIF: drawings have few
_FASTEST_GIF = 50  # frames per second: delays are in 1/100 s, viewers slow down shorter ones


def check_film(kind: str, fps: float) -> None:
    """Reject a format that this installation cannot write, before any drawing.

    Raises
    ------
    InputError
        If the format is unknown, or too slow for this number of frames per second.
    MissingPackageError
        If Pillow, or for MP4 ffmpeg, is missing.
    """
    if kind not in FILM_FORMATS:
        known = ", ".join(FILM_FORMATS)
        raise InputError(f'there is no film format "{kind}" (formats: {known})')
    if kind == "mp4":
        _ffmpeg()
        return
    if kind == "gif" and fps > _FASTEST_GIF:
        raise InputError(f"a GIF plays at most {_FASTEST_GIF} frames per second, not {fps:g}")
    _pillow()


def film_bytes(pictures: Iterable[AnyArray], kind: str, fps: float) -> bytes:
    """The content of a film file; it repeats endlessly, except that an MP4 plays once.

    Parameters
    ----------
    pictures : iterable of arrays (height, width, 3), uint8
    kind : str
        One of :data:`FILM_FORMATS`.
    fps : float
        Frames per second.

    Raises
    ------
    InputError, MissingPackageError
        As :func:`check_film`, or if ffmpeg fails.
    """
    check_film(kind, fps)
    if kind == "mp4":
        return _film_of_ffmpeg(pictures, fps)
    first, *others = _images(pictures, kind)
    buffer = io.BytesIO()
    # Milliseconds of every frame, rounded so that the total duration is exact.
    own = {
        "gif": {"format": "GIF", "optimize": False, "disposal": 1},
        "apng": {"format": "PNG"},
        "webp": {"format": "WEBP", "lossless": True, "method": 2},
    }[kind]
    first.save(
        buffer,
        save_all=True,
        append_images=others,
        duration=round(1000 / fps),
        loop=0,
        **own,  # type: ignore[arg-type]
    )
    return buffer.getvalue()


def _images(pictures: Iterable[AnyArray], kind: str) -> Iterator[Image]:
    image = _pillow()
    palette = None
    for pixels in pictures:
        one = image.fromarray(pixels)
        if kind == "gif":
            # One palette for all frames, otherwise colours flicker.
            if palette is None:
                palette = one.quantize(colors=_COLOURS, method=image.Quantize.MEDIANCUT)
            one = one.quantize(palette=palette, dither=image.Dither.NONE)
        yield one


def _film_of_ffmpeg(pictures: Iterable[AnyArray], fps: float) -> bytes:
    frames = iter(pictures)
    first = next(frames)
    height, width = first.shape[:2]
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "film.mp4"
        command = [
            _ffmpeg(), "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-", "-an", "-c:v", "libx264",
            "-pix_fmt", "yuv420p", "-crf", "18", "-movflags", "+faststart", str(target),
        ]  # fmt: skip
        with (
            tempfile.TemporaryFile() as said,
            subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as program,
        ):
            assert program.stdin is not None
            try:
                program.stdin.write(first.tobytes())
                for frame in frames:
                    program.stdin.write(frame.tobytes())
                program.stdin.close()
            except BrokenPipeError:
                pass  # ffmpeg ended early: its error output has the reason
            code = program.wait()
            said.seek(0)
            story = said.read().decode(errors="replace").strip()
        if code or not target.exists():
            raise InputError(f"ffmpeg could not write the film: {story or f'exit code {code}'}")
        return target.read_bytes()


def _pillow() -> ModuleType:
    with installed_with("plot", "GIF, APNG and WebP need Pillow"):
        from PIL import Image
    return Image


def _ffmpeg() -> str:
    found = shutil.which("ffmpeg")
    if found is None:
        raise MissingPackageError(
            "MP4 needs the program ffmpeg, which is not on the PATH: install it "
            "(apt-get install ffmpeg, brew install ffmpeg), or write .gif or .html"
        )
    return found
