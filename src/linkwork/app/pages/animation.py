"""Film files: GIF, animated PNG and WebP written by Pillow, MP4 by ffmpeg."""

from __future__ import annotations

import io
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np

from linkwork.app.pages.film import film
from linkwork.app.pages.moving_scene import moving_scene
from linkwork.app.pages.offline_page import offline_page
from linkwork.app.pages.packing import falling, in_time, play_order
from linkwork.app.pages.page_building import Loops, motion_page
from linkwork.app.pages.page_data import PageData, SolvingPage
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.drawing.annotations import Force
from linkwork.core.drawing.pose import inputs_caption
from linkwork.core.drawing.scene import THEMES, theme_named
from linkwork.core.foundation.arrays import AnyArray
from linkwork.core.foundation.errors import InputError, MissingPackageError
from linkwork.core.foundation.files import as_path, save_bytes, suffix_of
from linkwork.core.foundation.loading import installed_with
from linkwork.core.foundation.names import as_names
from linkwork.core.foundation.values import given_or
from linkwork.core.motion.iterating import moving_loops
from linkwork.core.results.motion import Motion

if TYPE_CHECKING:
    from PIL.Image import Image

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
    settings = {
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
        **settings,  # type: ignore[arg-type]
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
    program = shutil.which("ffmpeg")
    if program is None:
        raise MissingPackageError(
            "MP4 needs the program ffmpeg, which is not on the PATH: install it "
            "(apt-get install ffmpeg, brew install ffmpeg), or write .gif or .html"
        )
    return program


# ----------------------------------------------------------------------
# Animations: a motion as an HTML page or as a film.


#: Formats by suffix.
ANIMATION_FORMATS = ("html", *FILM_FORMATS)

_LASTING = 4.8  # default duration of a film [s]


@dataclass(frozen=True, kw_only=True)
class FilmOptions:
    """Options of a film.

    Parameters
    ----------
    fps : float
        Frames per second.
    rows : int, optional
        Number of positions in the film; by default enough for about five seconds.
    dpi : float
        Pixels per inch; the longer side of the drawing is six inches.
    theme : str
        ``light`` or ``dark``.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.app.FilmOptions(fps=25, rows=100).rows
    100
    """

    fps: float = 25.0
    rows: int | None = None
    dpi: float = 110.0
    theme: str = "light"


def check_animation(path: str | Path, options: FilmOptions | None = None) -> str:
    """The format of a file by its suffix, if this installation can write it.

    Raises
    ------
    InputError
        If the suffix is not of a known format, or an option is out of range.
    MissingPackageError
        If the package that writes the format is not installed.
    """
    chosen = given_or(FilmOptions(), "options", options)
    suffixes = [f".{name}" for name in ANIMATION_FORMATS]
    kind = suffix_of(as_path(path), "an animation", suffixes)[1:]
    if not 0 < chosen.fps <= 240:
        raise InputError(
            f"a film needs more than 0 and at most 240 frames per second, got {chosen.fps:g}"
        )
    if chosen.rows is not None and chosen.rows < 2:
        raise InputError(f"a film needs at least 2 rows, not {chosen.rows}")
    if kind != "html":
        check_film(kind, chosen.fps)
    return kind


def animation(
    motions: Mapping[str, Motion],
    kind: str,
    *,
    options: FilmOptions | None = None,
    equations: Sequence[tuple[str, str]] = (),
    loops: Loops | None = None,
    forces: Sequence[Force] = (),
    solver: SolvingPage | None = None,
    progress: Callable[[float], None] | None = None,
) -> bytes:
    """The content of a file that shows motions of one mechanism.

    Parameters
    ----------
    motions : Mapping[str, Motion]
        By the name of the circuit; a film shows the first motion with a position.
    kind : str
        One of :data:`ANIMATION_FORMATS`.
    options : FilmOptions, optional
        For films.
    equations : sequence of (str, str)
        Labels and MathML of the loop equations, for a page.
    loops : callable, optional
        See :func:`~linkwork.app.pages.page_building.motion_page`.
    forces : sequence of Force
        Drawn as arrows, for a page.
    solver : SolvingPage, optional
        For a page of one motion, with sliders.
    progress : callable, optional
        Called with the finished fraction of a film, 0 to 1.

    Raises
    ------
    InputError, MissingPackageError
        If there is nothing to draw, or this installation cannot write the format.
    """
    if kind == "html":
        page = motion_page(motions, equations=equations, loops=loops, forces=forces)
        if solver is not None:
            page = _computed_in_page(page, solver)
        return offline_page(page, solver).encode()
    motion = next((motion for motion in motions.values() if motion.found.any()), None)
    if motion is None:
        raise InputError("there is no motion to show: no position was found")
    return _film(motion, kind, given_or(FilmOptions(), "options", options), progress)


def _computed_in_page(page: PageData, solver: SolvingPage) -> PageData:
    """The page without numbers that it cannot compute again."""
    (motion,) = page.motions
    known = set(solver.data.columns)
    columns = tuple(c for c in motion.columns if c.group == "input" or c.name in known)
    return replace(page, motions=(replace(motion, columns=columns, numbers=()),))


def animate_motion(
    motion: Motion,
    path: str | Path,
    *,
    options: FilmOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write a motion to a file; see :meth:`linkwork.core.results.motion.Motion.animate`."""
    kind = check_animation(path, options)
    content = animation({"motion": motion}, kind, options=options, progress=progress)
    save_bytes(content, path)


def _film(
    motion: Motion, kind: str, options: FilmOptions, progress: Callable[[float], None] | None
) -> bytes:
    rows = _film_rows(motion, options)
    captions = [
        inputs_caption(
            {name: round(float(values[row]), 6) for name, values in motion.inputs.items()},
            motion.input_units,
            motion.units,
        )
        for row in rows
    ]
    backwards = any(part.backwards for part in motion.skeleton.driven[:1])
    turned = [falls != backwards for falls in falling(motion, rows)]
    scene = moving_scene(motion)
    theme = theme_named(options.theme, THEMES)
    pictures = film(scene, rows, captions, turned, dpi=options.dpi, theme=theme)

    def with_progress() -> Iterator[AnyArray]:
        for k, picture in enumerate(pictures, 1):
            yield picture
            if progress is not None:
                progress(k / len(rows))

    return film_bytes(with_progress(), kind, options.fps)


def _film_rows(motion: Motion, options: FilmOptions) -> list[int]:
    """The rows in playing order: around a closed circuit, or back and forth; over the time at
    equal intervals.
    """
    order, closed = play_order(motion)
    pictures = options.rows or max(2, round(_LASTING * options.fps))
    if in_time(motion):
        times = next(iter(motion.inputs.values()))[order]
        at = np.linspace(times[0], times[-1], min(pictures, len(order)))
        return [int(row) for row in order[np.searchsorted(times, at, side="right") - 1]]
    if closed:
        count = min(pictures, len(order))
        return [int(order[k * len(order) // count]) for k in range(count)]
    count = min(pictures if options.rows else pictures // 2 + 1, len(order))
    there = [int(order[k]) for k in np.linspace(0, len(order) - 1, count).round().astype(int)]
    return there + there[-2:0:-1]


def animate(
    mechanism: Mechanism,
    path: str | Path,
    motion: Motion | None = None,
    *,
    all_circuits: bool = False,
    forces: Sequence[Force] = (),
    sliders: Sequence[str] = (),
    options: FilmOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write the motion as an animated page or a film; see :meth:`~linkwork.Mechanism.animate`."""
    kind = check_animation(path, options)
    if all_circuits and (motion is not None or kind != "html"):
        raise InputError("all circuits need the page of a mechanism: use the suffix .html")
    if forces and kind != "html":
        raise InputError("only a page shows forces: use the suffix .html")
    solver = None
    if sliders:
        if kind != "html" or all_circuits or motion is not None:
            raise InputError(
                "sliders are for a page of one sweep: use the suffix .html, and leave out "
                "motion and all_circuits"
            )
        motion = mechanism.sweep(progress=progress)
        solver = solving_page(mechanism, sliders, motion)
    motions = shown_motions(mechanism, motion, all_circuits, progress)
    content = animation(
        motions,
        kind,
        options=options,
        equations=mechanism.equations().mathml(),
        loops=partial(moving_loops, mechanism.model),
        forces=forces,
        solver=solver,
        progress=progress,
    )
    save_bytes(content, path)


def solving_page(mechanism: Mechanism, sliders: Sequence[str], motion: Motion) -> SolvingPage:
    """The solver for a page that shows a sweep with sliders; see :meth:`animate`."""
    # kernels are loaded when a page with sliders is written
    from linkwork.app.pages.offline_page import page_solver
    from linkwork.families.recorded_design import record_design

    if not motion.found.any():
        raise InputError("there is no motion to change with sliders: no position was found")
    design = record_design(mechanism.model, as_names("sliders", sliders))
    return page_solver(design, motion, design.changed())


def shown_motions(
    mechanism: Mechanism,
    motion: Motion | None,
    all_circuits: bool,
    progress: Callable[[float], None] | None = None,
) -> dict[str, Motion]:
    """The displayed motions, by name."""
    if all_circuits:
        return mechanism.cycles(progress=progress)
    return {"motion": mechanism.cycle() if motion is None else motion}
