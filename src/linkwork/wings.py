"""The wings around the core: what each of them adds, loaded on first use.

The core imports no wing. It calls them by name, ``wings.use("circuits.inverting").inversion(…)``,
and finds what they add in this table. A package outside adds a wing by an entry point of the group
``linkwork.wings`` that names a :class:`Wing`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from typing import Any

#: The group of entry points by which other packages add wings.
GROUP = "linkwork.wings"


@dataclass(frozen=True)
class Writer:
    """A kind of file: the place of its function of a mechanism and a path, and its suffixes."""

    place: str
    suffixes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Wing:
    """What a package adds to the core; places are written ``module:name``.

    Parameters
    ----------
    module : str
        The public package.
    title : str
        What it does, in a few words: a heading of the list of commands.
    parts : Mapping[str, str]
        Tables of a mechanism file, with the place of the class of their parts.
    quantities : sequence of str
        Places of tuples of row quantities.
    commands : Mapping[str, str]
        Commands, each with a sentence for their list; the function of ``name`` is
        ``name_command`` in the module ``commands`` of the package.
    writers : Mapping[str, Writer]
        Kinds of files by name.
    """

    module: str
    title: str
    parts: Mapping[str, str] = field(default_factory=dict)
    quantities: tuple[str, ...] = ()
    commands: Mapping[str, str] = field(default_factory=dict)
    writers: Mapping[str, Writer] = field(default_factory=dict)


WINGS = (
    Wing(
        module="linkwork.core",
        title="Files, equations, positions, the cycle",
        commands={
            "examples": "List the mechanisms of the library and tasks, or copy one.",
            "new": "Write a new file of a mechanism or a task.",
            "check": "Report how the file was read: loops, unknowns, mobility, problems.",
            "equations": "Show the loop-closure equations and the Jacobian.",
            "quantities": "List all quantities of a mechanism.",
            "solve": "Solve one position by Newton-Raphson.",
            "sweep": "Solve the whole cycle, following the branch of the initial guess.",
            "draw": "Draw one position, with the paths of the traced points.",
            "schema": "Print the JSON Schema of mechanism files.",
        },
    ),
    Wing(
        module="linkwork.contacts",
        title="Cams, curves, non-circular gears",
        parts={
            "noncircular_gears": "linkwork.contacts.curves:NoncircularGear",
            "cams": "linkwork.contacts.cams:Cam",
            "curves": "linkwork.contacts.curves:Curve",
        },
    ),
    Wing(
        module="linkwork.couplings",
        title="Linear couplings",
        parts={"couplings": "linkwork.couplings.coupling:LinearCoupling"},
    ),
    Wing(
        module="linkwork.circuits",
        title="Assemblies",
        commands={
            "configurations": "List all assembly configurations at one input value.",
            "circuits": "Find every circuit, its branches, dead points and change points.",
        },
    ),
    Wing(
        module="linkwork.forces",
        title="Forces and motion in time",
        commands={
            "forces": "Compute the efforts of the inputs and the reactions of all joints.",
            "simulate": "Compute the motion in time under masses, loads, springs and a motor.",
        },
    ),
    Wing(
        module="linkwork.design",
        title="Machine design",
        commands={
            "sensitivity": "Compute how much a quantity changes with each number of a mechanism.",
            "tolerance": "Compute how tolerances and clearances affect a quantity.",
            "design": "Choose flywheel, motor and counterweights; harmonics and curvature.",
        },
    ),
    Wing(
        module="linkwork.synthesis",
        title="Synthesis",
        commands={
            "synthesize": "Find mechanisms for a task: poses, points, a curve or a function.",
            "atlas": "Find mechanisms whose paths resemble a closed curve (CSV: x, y).",
        },
    ),
    Wing(
        module="linkwork.families",
        title="Many designs",
        commands={
            "study": "Compute many designs of a mechanism from a plan file.",
            "compile": "Compile the code of families and long tables, once.",
        },
    ),
    Wing(
        module="linkwork.writers",
        title="Pictures and files for other programs",
        commands={
            "plot": "Plot columns, paths, hodographs, transmission angles or circuits.",
            "export": "Write a workbook, program, report, plates, robot or text.",
        },
        writers={
            "workbook": Writer("linkwork.writers.workbook.workbook:write_workbook", (".xlsx",)),
            "program": Writer(
                "linkwork.writers.code.programs:write_program", (".py", ".m", ".c", ".js", ".st")
            ),
            "plates": Writer(
                "linkwork.writers.plates.files:write_plates", (".dxf", ".stl", ".3mf", ".step")
            ),
            "robot": Writer("linkwork.writers.robot.files:write_robot", (".mjcf", ".sdf", ".urdf")),
            "report": Writer(
                "linkwork.writers.report.report:write_report", (".html", ".pdf", ".docx", ".md")
            ),
        },
    ),
    Wing(
        module="linkwork.readers",
        title="Files of other programs",
        commands={
            "import": "Read a mechanism from a file of another program.",
        },
        writers={
            form: Writer(f"linkwork.readers.importing:write_{form}")
            for form in ("pmks", "pylinkage", "pyslvs")
        },
    ),
    Wing(
        module="linkwork.app",
        title="The app",
        commands={
            "animate": "Write the motion as an animated page or a film.",
            "view": "Open the app: draw, edit and show a mechanism in a browser.",
            "web": "Write the app as static files: it solves in the browser alone.",
            "link": "Print a link that contains the whole mechanism file.",
        },
    ),
)


@cache
def wings() -> tuple[Wing, ...]:
    """All wings: those of Linkwork, then those of installed packages."""
    from importlib.metadata import entry_points

    return (*WINGS, *(entry.load() for entry in entry_points(group=GROUP)))


def use(name: str) -> Any:
    """The public package of a wing, imported on first use."""
    return import_module(f"linkwork.{name}")


def load(place: str) -> Any:
    """The object at a place ``module:name``."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def command(name: str) -> Any:
    """The function of a command; None if no wing has one of this name."""
    # other packages are looked through only for a name that is none of ours: that takes time
    known = WINGS if any(name in wing.commands for wing in WINGS) else wings()
    for wing in known:
        if name in wing.commands:
            return load(f"{wing.module}.commands:{name}_command")
    return None
