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
from linkwork.writers.robot.robot import Couplings, JointPolynomial, Robot, TreeJoint, couplings_of

#: The ground in MJCF and SDF.
WORLD = "world"
_ACROSS = "0.0 0.0 1.0"  # the axis of pins
#: Kinds of joints in URDF and SDF.
_KINDS = {PairKind.PIN: "revolute", PairKind.SLIDE: "prismatic", PairKind.FIXED: "fixed"}


def numbers(*values: float) -> str:
    """Numbers as text that reads back as the same numbers."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def vector(z: complex) -> str:
    """A place or direction of the plane as x, y, z."""
    return numbers(z.real, z.imag, 0.0)


def pose(place: complex, angle: float = 0.0) -> str:
    """A place and an angle of the plane as x, y, z, roll, pitch, yaw."""
    return numbers(place.real, place.imag, 0.0, 0.0, 0.0, angle)


def axis_of(robot: Robot, joint: TreeJoint) -> str:
    """The axis of a pin or slide in the frame of its child."""
    return vector(robot.axis(joint)) if joint.edge.kind is PairKind.SLIDE else _ACROSS


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
    element(root, "option", gravity=vector(robot.gravity()))
    places = {GROUND: element(root, "worldbody")}
    for point, place in robot.points(GROUND).items():
        _site(places[GROUND], GROUND, point, place)
    for joint in robot.tree.joints:
        place, angle = robot.mounted(joint)
        turned = numbers(math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2))
        parent = places[joint.parent]
        body = element(parent, "body", name=joint.child, pos=vector(place), quat=turned)
        places[joint.child] = body
        bar = robot.inertia(joint.child)
        mass, inertia = numbers(bar.mass), numbers(*[bar.inertia] * 3)
        element(body, "inertial", pos=vector(bar.center), mass=mass, diaginertia=inertia)
        kind = _MJCF_KINDS.get(joint.edge.kind)
        if kind is not None:
            element(body, "joint", name=joint.name, type=kind, axis=axis_of(robot, joint))
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
    element(body, "site", name=f"{name}/{point}", pos=vector(place), size="0.002")


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
        gravity = vector(robot.gravity())
        notes.append(f"The world's gravity has to be {gravity}: a model cannot give it.")
    for joint in robot.tree.joints:
        _sdf_link(model, robot, joint)
    for joint in robot.tree.joints:  # those of ground cannot be frames of a model
        for point, place in robot.points(joint.child).items():
            frame = element(model, "frame", name=f"{joint.child}/{point}", attached_to=joint.child)
            element(frame, "pose", pose(place))
    for joint in robot.tree.joints:
        bodies = joint.parent, joint.child
        _sdf_joint(model, joint.edge.kind, joint.name, bodies, axis=axis_of(robot, joint))
    for k, edge in enumerate(robot.tree.closing):
        _closing(model, robot, edge, k)
    return written(root, notes)


def _sdf_link(model: Tree.Element, robot: Robot, joint: TreeJoint) -> None:
    link = element(model, "link", name=joint.child)
    element(link, "pose", pose(*robot.frame(joint.child)))
    if not robot.gravity():
        element(link, "gravity", "false")
    bar = robot.inertia(joint.child)
    inertial = element(link, "inertial")
    element(inertial, "pose", pose(bar.center))
    element(inertial, "mass", numbers(bar.mass))
    inertia = element(inertial, "inertia")
    for name in ("ixx", "iyy", "izz"):
        element(inertia, name, numbers(bar.inertia))


def _is_reserved(name: str) -> bool:
    return len(name) >= 4 and name.startswith("__") and name.endswith("__")


def _sdf_joint(
    model: Tree.Element,
    kind: PairKind,
    name: str,
    bodies: tuple[str, str],
    *,
    place: complex = 0j,
    axis: str = _ACROSS,
) -> None:
    """A joint; its frame is at a place in the child's frame."""
    parent, child = (WORLD if body == GROUND else body for body in bodies)
    made = element(model, "joint", name=name, type=_KINDS[kind])
    element(made, "parent", parent)
    element(made, "child", child)
    element(made, "pose", pose(place))
    if kind is not PairKind.FIXED:
        element(element(made, "axis"), "xyz", axis)


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
        _polynomial(root, name, polynomial, couplings.leading.name)
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
    element(inertial, "origin", xyz=vector(bar.center), rpy="0 0 0")
    element(inertial, "mass", value=numbers(bar.mass))
    diagonal = dict.fromkeys(("ixx", "iyy", "izz"), numbers(bar.inertia))
    element(inertial, "inertia", **diagonal, ixy="0", ixz="0", iyz="0")


def _urdf_joint(root: Tree.Element, robot: Robot, joint: TreeJoint, couplings: Couplings) -> None:
    leads = joint.name == couplings.leading.name
    low, high = couplings.limits
    whole = leads and not any(couplings.stopped) and high - low >= 2.0 * math.pi - 1e-9
    turns = whole and joint.edge.kind is PairKind.PIN
    kind = "continuous" if turns else _KINDS[joint.edge.kind]
    made = element(root, "joint", name=joint.name, type=kind)
    place, angle = robot.mounted(joint)
    element(made, "origin", xyz=vector(place), rpy=numbers(0, 0, angle))
    element(made, "parent", link=joint.parent)
    element(made, "child", link=joint.child)
    if joint.edge.kind is PairKind.FIXED:
        return
    element(made, "axis", xyz=axis_of(robot, joint))
    form = None if leads else couplings.joints[joint.name]
    low, high = couplings.limits if form is None else form.range
    ends = {} if turns else {"lower": numbers(low), "upper": numbers(high)}
    element(made, "limit", **ends, effort=_STRONGEST, velocity=_FASTEST)
    if form is not None:
        factor, offset = map(numbers, form.line)
        element(made, "mimic", joint=couplings.leading.name, multiplier=factor, offset=offset)


def _polynomial(root: Tree.Element, name: str, form: JointPolynomial, driven: str) -> None:
    low, high = map(numbers, form.series.domain.tolist())
    made = element(root, "coupling", numbers(*form.series.coef.tolist()), joint=name, driven=driven)
    errors = (("error", form.error), ("mimic_error", form.line_error))
    for key, text in (("low", low), ("high", high), *((k, f"{e:.3e}") for k, e in errors)):
        made.set(key, text)


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
