"""XML elements of the formats of robots."""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from xml.etree import ElementTree as Tree

from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import as_path, save_text, suffix_of
from linkwork.core.foundation.names import GROUND
from linkwork.core.mechanism.part.part import Pair, PairKind
from linkwork.core.motion.model import Model
from linkwork.core.results.motion import Motion
from linkwork.core.results.position import Position
from linkwork.writers.robot.joint_tree import TreeJoint
from linkwork.writers.robot.robot import Couplings, JointPolynomial, Robot, couplings_of

#: The ground in MJCF and SDF.
WORLD = "world"


def numbers(*values: float) -> str:
    """Numbers as text that reads back as the same numbers."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def element(parent: Tree.Element, tag: str, text: str = "", **attributes: str) -> Tree.Element:
    """Add an element."""
    made = Tree.SubElement(parent, tag, attributes)
    made.text = text or None
    return made


def written(root: Tree.Element, notes: list[str]) -> str:
    """The document, with notes as a comment at its top."""
    Tree.indent(root)
    lines = [f"Written by Linkwork {metadata.version('linkwork')}.", *notes]
    # a comment must not contain two hyphens in a row
    text = "\n  ".join(lines).replace("--", "- -")
    return f"<!--\n  {text}\n-->\n{Tree.tostring(root, encoding='unicode')}\n"


# ----------------------------------------------------------------------
# MJCF: the tree as nested bodies, loops closed by equality constraints.


_MJCF_KINDS = {PairKind.PIN: "hinge", PairKind.SLIDE: "slide"}


def mjcf_of(robot: Robot) -> str:
    """Write a mechanism for MuJoCo, with its real loops."""
    root = Tree.Element("mujoco", model=robot.name)
    element(root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
    fall = robot.gravity()
    element(root, "option", gravity=numbers(fall.real, fall.imag, 0.0))
    places = {GROUND: element(root, "worldbody")}
    for point, place in robot.points(GROUND).items():
        _site(places[GROUND], GROUND, point, place)
    for joint in robot.tree.joints:
        position, angle = robot.mounted(joint)
        body = places[joint.child] = element(
            places[joint.parent],
            "body",
            name=joint.child,
            pos=numbers(position.real, position.imag, 0.0),
            quat=numbers(math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)),
        )
        inertia = robot.inertia(joint.child)
        element(
            body,
            "inertial",
            pos=numbers(inertia.center.real, inertia.center.imag, 0.0),
            mass=numbers(inertia.mass),
            diaginertia=numbers(*[inertia.inertia] * 3),
        )
        if joint.edge.kind in _MJCF_KINDS:
            along = robot.axis(joint) if joint.edge.kind is PairKind.SLIDE else None
            axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
            kind = _MJCF_KINDS[joint.edge.kind]
            element(body, "joint", name=joint.name, type=kind, axis=numbers(*axis))
        for point, place in robot.points(joint.child).items():
            _site(body, joint.child, point, place)
    _constraints(root, robot)
    driven = {name: joint for name, joint in robot.driven().items() if joint is not None}
    if driven:
        motors = element(root, "actuator")
        for name, joint in driven.items():
            motor = "input" if len(robot.linkage.inputs) == 1 else f"input:{name}"
            element(motors, "motor", name=motor, joint=joint.name)
    return written(root, robot.notes())


def _site(body: Tree.Element, name: str, point: str, place: complex) -> None:
    pos = numbers(place.real, place.imag, 0.0)
    element(body, "site", name=f"{name}/{point}", pos=pos, size="0.002")


def _constraints(root: Tree.Element, robot: Robot) -> None:
    """Pins and welds that close loops, and couplings of wheels as tendons of fixed length."""
    tree = robot.tree
    couplings = [(one, tree.ratios(one)) for one in tree.graph.couplings]
    if couplings:
        tendons = element(root, "tendon")
        for coupling, ratios in couplings:
            size = max(ratios.values(), key=abs)
            fixed = element(tendons, "fixed", name=coupling.name)
            for name, ratio in ratios.items():
                factor = robot.per_metre(name) * ratio / size
                element(fixed, "joint", joint=name, coef=numbers(factor))
    if not (tree.closing or couplings):
        return
    equality = element(root, "equality")
    for edge in tree.closing:
        # of welds MuJoCo takes the relative pose in the start position
        if edge.kind is PairKind.FIXED:
            bodies = (WORLD if body == GROUND else body for body in edge.bodies)
            element(equality, "weld", **dict(zip(("body1", "body2"), bodies, strict=True)))
        else:
            a, b = (f"{body}/{edge.point}" for body in edge.bodies)
            element(equality, "connect", site1=a, site2=b)
    for coupling, _ in couplings:
        element(equality, "tendon", tendon1=coupling.name)


# ----------------------------------------------------------------------
# SDF: bodies and all joints, those that close loops included.


_UNTITLED = "mechanism"
_SDF_KINDS = {PairKind.PIN: "revolute", PairKind.SLIDE: "prismatic", PairKind.FIXED: "fixed"}


def sdf_of(robot: Robot) -> str:
    """Write a mechanism as an SDF 1.9 model.

    Raises
    ------
    InputError
        If wheels are coupled: SDF has no equivalent for every such coupling; or if a link has a
        name that SDF reserves.
    """
    if robot.tree.graph.couplings:
        name = robot.tree.graph.couplings[0].name
        raise InputError(f'"{name}" couples turning wheels: SDF cannot describe it; write MJCF')
    reserved = [body for body in robot.tree.graph.bodies if _is_reserved(body)]
    if reserved:
        raise InputError(f'link "{reserved[0]}" has a name that SDF reserves: rename it')
    root = Tree.Element("sdf", version="1.9")
    notes = [*robot.notes(), "Joints whose names begin with loop: close loops."]
    driven = [joint.name for joint in robot.driven().values() if joint is not None]
    if driven:
        notes.append(f"Driven joints, whose motors a model cannot give: {', '.join(driven)}.")
    title = robot.name
    if not title or title == WORLD or _is_reserved(title) or "::" in title:
        notes.append(f'The model is named "{_UNTITLED}": SDF does not allow "{title}".')
        title = _UNTITLED
    model = element(root, "model", name=title)
    if robot.gravity():
        fall = robot.gravity()
        gravity = numbers(fall.real, fall.imag, 0.0)
        notes.append(f"The world's gravity has to be {gravity}: a model cannot give it.")
    for joint in robot.tree.joints:
        _sdf_link(model, robot, joint, gravity=bool(robot.gravity()))
    for joint in robot.tree.joints:
        _points(model, robot, joint.child)
    for joint in robot.tree.joints:
        kind = joint.edge.kind
        along = robot.axis(joint) if kind is PairKind.SLIDE else None
        _sdf_joint(model, kind, joint.name, (joint.parent, joint.child), along=along)
    for k, edge in enumerate(robot.tree.closing):
        _closing(model, robot, edge, k)
    return written(root, notes)


def _sdf_link(model: Tree.Element, robot: Robot, joint: TreeJoint, *, gravity: bool) -> None:
    link = element(model, "link", name=joint.child)
    place, angle = robot.frame(joint.child)
    element(link, "pose", numbers(place.real, place.imag, 0, 0, 0, angle))
    if not gravity:
        element(link, "gravity", "false")
    bar = robot.inertia(joint.child)
    inertial = element(link, "inertial")
    element(inertial, "pose", numbers(bar.center.real, bar.center.imag, 0, 0, 0, 0))
    element(inertial, "mass", numbers(bar.mass))
    inertia = element(inertial, "inertia")
    for name in ("ixx", "iyy", "izz"):
        element(inertia, name, numbers(bar.inertia))


def _is_reserved(name: str) -> bool:
    return len(name) >= 4 and name.startswith("__") and name.endswith("__")


def _points(model: Tree.Element, robot: Robot, body: str) -> None:
    """The points of a body as frames: those of ground cannot be frames of a model."""
    for point, place in robot.points(body).items():
        frame = element(model, "frame", name=f"{body}/{point}", attached_to=body)
        element(frame, "pose", numbers(place.real, place.imag, 0, 0, 0, 0))


def _sdf_joint(
    model: Tree.Element,
    kind: PairKind,
    name: str,
    bodies: tuple[str, str],
    *,
    along: complex | None = None,
    place: complex = 0j,
) -> None:
    """A joint; its frame is at a place in the child's frame."""
    parent, child = (WORLD if body == GROUND else body for body in bodies)
    made = element(model, "joint", name=name, type=_SDF_KINDS[kind])
    element(made, "parent", parent)
    element(made, "child", child)
    element(made, "pose", numbers(place.real, place.imag, 0, 0, 0, 0))
    if kind is not PairKind.FIXED:
        axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
        element(element(made, "axis"), "xyz", numbers(*axis))


def _closing(model: Tree.Element, robot: Robot, edge: Pair, k: int) -> None:
    # the child must not be ground
    first, second = edge.bodies
    parent, child = (second, first) if second == GROUND else (first, second)
    place = robot.local(child, robot.place(edge.point))
    _sdf_joint(model, edge.kind, f"loop:{k + 1}:{edge.name}", (parent, child), place=place)


# ----------------------------------------------------------------------
# URDF: the tree; joints follow the driven one by ``mimic``, their polynomials are stated.


_NEAR = 1e-9  # rad or m
_FASTEST, _STRONGEST = "100.0", "1000.0"  # URDF demands both limits


def urdf_of(robot: Robot, motion: Motion) -> str:
    """Write a mechanism as a tree without loops.

    Raises
    ------
    InputError
        If the joints cannot follow one driven joint.
    """
    couplings = couplings_of(robot, motion)
    root = Tree.Element("robot", name=robot.name)
    element(root, "link", name=GROUND)
    for joint in robot.tree.joints:
        _urdf_link(root, robot, joint)
        _urdf_joint(root, robot, joint, couplings)
    for name, polynomial in couplings.joints.items():
        _polynomial(root, name, polynomial, couplings)
    others = [j.name for j in robot.driven().values() if j not in (None, couplings.leading)]
    step = f"Driven as well, here in step with it as in the table: {', '.join(others)}."
    return written(root, [*robot.notes(), *_notes(couplings), *([step] if others else [])])


def _notes(couplings: Couplings) -> list[str]:
    low, high = couplings.limits
    ends = ["dead point" if stop else "end of the table" for stop in couplings.stopped]
    lines = [
        "URDF has no loops: joints follow the driven one; mimic is a straight line.",
        "Each element coupling has the true relation: coefficients c_k of Chebyshev polynomials",
        "T_k(s) of s = (2 x - low - high)/(high - low), x the value of the driven joint;",
        "error and mimic_error are the largest differences, estimated between table rows.",
        f"Driven joint: {couplings.leading.name} from {low:.9g} ({ends[0]}) to {high:.9g} "
        f"({ends[1]}).",
        "Limits of effort and velocity are placeholders.",
    ]
    if not low <= _NEAR or not high >= -_NEAR:
        lines.append("The start position is not between these limits.")
    return lines


def _urdf_link(root: Tree.Element, robot: Robot, joint: TreeJoint) -> None:
    bar = robot.inertia(joint.child)
    inertial = element(element(root, "link", name=joint.child), "inertial")
    element(inertial, "origin", xyz=numbers(bar.center.real, bar.center.imag, 0.0), rpy="0 0 0")
    element(inertial, "mass", value=numbers(bar.mass))
    diagonal = dict.fromkeys(("ixx", "iyy", "izz"), numbers(bar.inertia))
    element(inertial, "inertia", **diagonal, ixy="0", ixz="0", iyz="0")


def _urdf_joint(root: Tree.Element, robot: Robot, joint: TreeJoint, couplings: Couplings) -> None:
    leads = joint.name == couplings.leading.name
    low, high = couplings.limits
    kind = {PairKind.FIXED: "fixed", PairKind.PIN: "revolute", PairKind.SLIDE: "prismatic"}
    whole = leads and not any(couplings.stopped) and high - low >= 2.0 * math.pi - 1e-9
    turns = whole and joint.edge.kind is PairKind.PIN
    made = element(
        root, "joint", name=joint.name, type="continuous" if turns else kind[joint.edge.kind]
    )
    place, angle = robot.mounted(joint)
    element(made, "origin", xyz=numbers(place.real, place.imag, 0.0), rpy=numbers(0, 0, angle))
    element(made, "parent", link=joint.parent)
    element(made, "child", link=joint.child)
    if joint.edge.kind is PairKind.FIXED:
        return
    along = robot.axis(joint) if joint.edge.kind is PairKind.SLIDE else None
    axis = (0.0, 0.0, 1.0) if along is None else (along.real, along.imag, 0.0)
    element(made, "axis", xyz=numbers(*axis))
    if not leads:
        low, high = couplings.joints[joint.name].range
    ends = {} if turns else {"lower": numbers(low), "upper": numbers(high)}
    element(made, "limit", **ends, effort=_STRONGEST, velocity=_FASTEST)
    if not leads:
        factor, offset = couplings.joints[joint.name].line
        leader = couplings.leading.name
        element(made, "mimic", joint=leader, multiplier=numbers(factor), offset=numbers(offset))


def _polynomial(root: Tree.Element, name: str, form: JointPolynomial, couplings: Couplings) -> None:
    low, high = form.series.domain.tolist()
    element(
        root,
        "coupling",
        numbers(*form.series.coef.tolist()),
        joint=name,
        driven=couplings.leading.name,
        low=numbers(low),
        high=numbers(high),
        error=f"{form.error:.3e}",
        mimic_error=f"{form.line_error:.3e}",
    )


# ----------------------------------------------------------------------
# A mechanism's file for a simulator of robots, in the format of its suffix.


_FORMATS = (".mjcf", ".urdf", ".sdf")


def check_robot_file(file: Path) -> str:
    """The suffix of a robot's file.

    Raises
    ------
    InputError
        If the format does not exist.
    """
    return suffix_of(file, "a robot", _FORMATS)


def robot_of(model: Model, start: Position, motion: Motion | None, file: Path) -> str:
    """Write a mechanism for a simulator of robots.

    Parameters
    ----------
    model : Model
    start : Position
        Where all joint values are zero.
    motion : Motion, optional
        The sweep through this position; URDF needs it for its polynomials and limits.
    file : Path
        Its suffix selects the format.

    Raises
    ------
    InputError
        If the format does not exist, or it cannot describe the mechanism.
    """
    suffix = check_robot_file(file)
    robot = Robot(model, start)
    if suffix == ".urdf":
        if motion is None:
            raise InputError("URDF has no loops: its joints need a motion to follow")
        return urdf_of(robot, motion)
    if WORLD in robot.tree.graph.bodies:
        raise InputError(
            f'link "{WORLD}" has the name of the ground in MJCF and SDF: rename it, or write URDF'
        )
    return mjcf_of(robot) if suffix == ".mjcf" else sdf_of(robot)


def write_robot(
    mechanism: Mechanism,
    path: str | Path,
    at: float | Mapping[str, float] | None = None,
    *,
    configuration: str | None = None,
    motion: Motion | None = None,
) -> None:
    """Write the mechanism for a simulator of robots.

    Parameters
    ----------
    path : str or Path
        The file; its suffix selects the format: ``.mjcf`` (MuJoCo, with the real loops),
        ``.sdf`` (with all joints), ``.urdf`` (a tree whose joints follow the driven one).
    at : float or mapping, optional
        The input of the start position, at which all joint values are zero; by default that of
        :meth:`~linkwork.Mechanism.solve`.
    configuration : str, optional
        The configuration of the start position.
    motion : Motion, optional
        Of URDF, the sweep through the start position that gives limits and polynomials; by
        default :meth:`~linkwork.Mechanism.sweep`.

    Raises
    ------
    InputError
        If the format does not exist, there is no start position or no equivalent of a part, or
        the file cannot be written.

    Examples
    --------
    >>> import linkwork as lw, pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     lw.example("four-bar").write(f"{folder}/bar.mjcf", at=60)
    ...     text = pathlib.Path(folder, "bar.mjcf").read_text("utf-8")
    >>> text.count("<joint "), text.count("<connect ")
    (3, 1)
    """
    suffix = check_robot_file(as_path(path))
    start = mechanism.solve(at, configuration=configuration)
    if suffix == ".urdf" and motion is None:
        motion = mechanism.sweep(configuration=configuration)
    text = robot_of(mechanism.model, start, motion, as_path(path))
    save_text(text, path)
