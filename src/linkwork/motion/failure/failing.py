"""Explain a failed position: open loops, remedies, nearest reachable input."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwork.foundation.angles import within_half_a_turn
from linkwork.foundation.arrays import Array
from linkwork.foundation.newton_trouble import NewtonTrouble
from linkwork.foundation.status import Status
from linkwork.motion.failure.dyads import dyad_of
from linkwork.motion.failure.newton_reasons import (
    Miss,
    doubtful_root,
    miss_of,
    root_beside_guess,
    trouble_of,
)
from linkwork.motion.failure.other_positions import (
    ElsewhereAt,
    block_positions,
    positions_elsewhere,
)
from linkwork.motion.failure.reach import (
    MOST_UNKNOWNS,
    ReachableRange,
    assembled_near,
    reach_towards,
)
from linkwork.motion.failure.remedies import remedies_of
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.tracking import turns_freely
from linkwork.numerics.block_solver import Block
from linkwork.numerics.continuation.branch_tracking import InputPath
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.proof.position_proof import prove, rounding_of_inputs
from linkwork.results.failure import Failure
from linkwork.results.motion import Limit
from linkwork.results.quantity import Kind

__all__ = [
    "another_root",
    "beyond_reach",
    "no_position",
    "root_not_proved",
    "without_circuit",
    "without_start",
]

#: How the positions that exist at given inputs are found, for every explanation.
ELSEWHERE: ElsewhereAt = positions_elsewhere


def no_position(
    model: Model, v: Array, status: Status, failed_block: int, options: NewtonOptions
) -> tuple[Status, Failure]:
    """Why Newton-Raphson from v (N,), inputs included, did not solve one block.

    Blocks before it are solved first. If the block has no position, the failure names its gap and
    remedies; otherwise the reason why Newton-Raphson missed the existing positions.
    """
    with np.errstate(all="ignore"):
        return _explain(model, v, status, failed_block, options)


def _explain(
    model: Model, v: Array, status: Status, failed_block: int, options: NewtonOptions
) -> tuple[Status, Failure]:
    solver = model.compiled.solver
    here = solver.solve(v[None, :], options).v[0].copy()
    block = solver.blocks[failed_block]
    # its own guess again: the failed iteration has moved it
    here[block.unknowns] = v[block.unknowns]
    miss = miss_of(block, here)
    exists = miss.closed
    if not exists and miss.known:
        exists = bool(len(block_positions(block, here)[0]))
    # equations without a loop have no length that could close them
    if not exists and miss.known and _loops_in(model, block):
        here[block.unknowns] = miss.v[: len(block.unknowns)]
        return Status.CANNOT_CLOSE, _cannot_close(model, block, failed_block, here, miss)
    trouble = trouble_of(block, here, status, miss, options)
    # the damped iteration is held everywhere where there is no position
    if trouble is NewtonTrouble.LOCAL_EXTREMUM and not exists:
        trouble = None
    what = status.value if trouble is None else f"{_head(status)}: {trouble.value}"
    meant: dict[str, float] = {}
    if miss.closed:
        meant = _name_unknowns(model, block, miss.v[: len(block.unknowns)])
    elif not exists and miss.known:
        what += "; " + _stays_at(model, block, miss)
    return status, _failure(
        model,
        v[solver.unknowns :],
        what=what,
        loops=_labels(model, block),
        trouble=trouble,
        meant=meant,
    )


def root_not_proved(model: Model, start: Array, found: Array, options: NewtonOptions) -> Failure:
    """What is known where formulas are small at ``found`` (N,), reached from ``start`` (N,), and no
    root is proved.
    """
    solver, status = model.compiled.solver, Status.ROOT_NOT_PROVED
    proof = prove(solver, found[None, :], rounding_of_inputs(found[None, :], solver.unknowns))
    block = solver.blocks[int(np.argmax(np.isinf(proof.existence_radius[0])))]
    here = found.copy()
    here[block.unknowns] = start[block.unknowns]
    with np.errstate(all="ignore"):
        known = doubtful_root(block, here, found, options)
    values = found[block.unknowns]
    names = list(_name_unknowns(model, block, values))

    def within(sizes: Array) -> str:
        return ", ".join(
            f"{name} = {x:.10g} ± {size:.2g}"
            for name, x, size in zip(names, values, sizes, strict=True)
        )

    # a box without a root that is smaller than the way to a multiple one says nothing of that
    if known.free.all() and not (known.order and (known.away > known.free).any()):
        why = f"no root exists for {within(known.free)}, which is proved"
    elif known.order:
        why = (
            f"the steps shrink as near a root of order {known.order}: "
            f"if there is one, it lies at about {within(known.away)}"
        )
    else:
        at = ", ".join(f"{name} = {x:.10g}" for name, x in zip(names, values, strict=True))
        why = f"near {at} no steps shrink as near a multiple root"
    worst = np.abs(known.f).max(initial=0.0)
    return _failure(
        model,
        found[solver.unknowns :],
        what=f"{status.value} (the residual is {worst:.2g}; {why})",
        loops=_labels(model, block),
    )


def without_start(model: Model, failure: Failure, inputs: Array) -> Failure:
    """A failure at the inputs of the guess, explained for other inputs (p,) that were asked for.

    Positions are searched at the inputs asked for; the nearest input is named if there are none.
    """
    here = _failure(model, inputs, what="")
    nearest = failure if not here.configurations else here
    return replace(
        failure,
        what="the motion starts at the input value of the guess, where there is no position: "
        f"{failure.what}",
        asked=here.asked,
        nearest_input=nearest.nearest_input,
        nearest_kind=nearest.nearest_kind,
        nearest_proved=nearest.nearest_proved,
        through=nearest.through,
        unreachable=nearest.unreachable,
        configurations=here.configurations,
        configuration_names=here.configuration_names,
        complete=here.complete,
        complete_likely=here.complete_likely,
    )


def without_circuit(model: Model, found: Array) -> Failure:
    """The failure at a position (N,) from which no circuit could be followed: it is singular."""
    solver = model.compiled.solver
    inputs = found[solver.unknowns :]
    where = _inputs_text(model, inputs)
    return _failure(
        model,
        inputs,
        what=f"position found{' at ' if where else ''}{where}, at a dead point or change point, "
        "but no motion passes through it",
    )


def another_root(model: Model, found: Array) -> Failure | None:
    """The failure at a position (N,) that is not the position next to the guess."""
    solver = model.compiled.solver
    here = found.copy()
    here[: solver.unknowns] = model.equations.start[: solver.unknowns]
    for block in solver.blocks:
        meant = root_beside_guess(block, here, found)
        if meant is not None:
            return _failure(
                model,
                found[solver.unknowns :],
                what=f"position found, but {NewtonTrouble.ANOTHER_ROOT.value}",
                loops=_labels(model, block),
                trouble=NewtonTrouble.ANOTHER_ROOT,
                meant=_name_unknowns(model, block, meant),
            )
        here[block.unknowns] = found[block.unknowns]
    return None


def beyond_reach(
    model: Model,
    v: Array,
    place: tuple[InputPath, int, float],
    status: Status,
    limits: tuple[Limit, ...],
) -> Failure:
    """Why the branch of a start v (N,) does not lead to a value of its path, and which one does.

    Parameters
    ----------
    place : (path, lead, asked)
        The path, the number of the input that measures it, and the value asked for.
    limits
        The limit that was met on the way.
    """
    path, lead, asked = place
    near = None
    if status is Status.OUT_OF_REACH:
        near = reach_towards(model, path, lead, v, asked)
    elif all(limit.located for limit in limits):
        near = _nearest_limit(model, path, lead, asked, limits)
    name = model.equations.inputs[lead].name
    unit = model.units.angle.sign if model.equations.inputs[lead].kind == "angle" else ""
    scale = float(model.input_scale[lead])
    turn = 2.0 * np.pi / scale if turns_freely(model) else np.inf
    met = " and ".join(
        f"{_nearest_by_turns(limit.input, asked / scale, turn):.10g}{unit}" for limit in limits
    )
    return _failure(
        model,
        path.at(asked),
        what=f"{status.value} (met at {name} = {met})",
        loops=tuple(dict.fromkeys(loop for limit in limits for loop in limit.loops)),
        reach=near,
    )


def _nearest_by_turns(value: float, asked: float, turn: float) -> float:
    """A value moved by whole turns as near to the value asked for as possible."""
    turns = round((asked - value) / turn)
    return value + turns * turn if turns else value


def _nearest_limit(
    model: Model, path: InputPath, lead: int, asked: float, limits: tuple[Limit, ...]
) -> ReachableRange:
    """The limit that was met nearest to the value asked."""
    scale = float(model.input_scale[lead])

    def away(limit: Limit) -> float:
        gap = limit.input * scale - asked
        return abs(math.remainder(gap, 2.0 * np.pi) if turns_freely(model) else gap)

    limit = min(limits, key=away)
    inputs = path.at(limit.input * scale) / model.input_scale
    inputs[lead] = limit.input
    kind = limit.kind.value.partition(":")[0]
    return ReachableRange(inputs=inputs, kind=kind, proved=False, first_dead_point=None)


def _head(status: Status) -> str:
    return status.value.partition(":")[0]


def _labels(model: Model, block: Block) -> tuple[str, ...]:
    return tuple(model.equations.labels[e] for e in block.equations)


def _loops_in(model: Model, block: Block) -> int:
    return sum(e < len(model.equations.loops) for e in block.equations)


def _name_unknowns(model: Model, block: Block, x: Array) -> dict[str, float]:
    """The unknowns (n,) of a block by name, in file units, angles within half a turn."""
    unknowns = [model.equations.unknowns[int(k)] for k in block.unknowns]
    turned = within_half_a_turn(x, block.system.is_angle[: len(x)])
    return {
        u.name: float(value / model.units.scale(Kind(u.kind)))
        for u, value in zip(unknowns, turned, strict=True)
    }


def _stays_at(model: Model, block: Block, miss: Miss) -> str:
    labels = _labels(model, block)
    worst = int(np.argmax(np.abs(miss.f)))
    return f'"{labels[worst % len(labels)]}" has at least the residual {miss.f[worst]:.6g} nearby'


def _cannot_close(model: Model, block: Block, number: int, here: Array, miss: Miss) -> Failure:
    """The loop, the size of the gap, lengths that would help, inputs that can be reached."""
    solver = model.compiled.solver
    inputs = here[solver.unknowns :]
    count = _loops_in(model, block)
    gaps = np.hypot(miss.f[:count], miss.f[count : 2 * count])
    dyad = dyad_of(block, here)
    total = dyad.gap if dyad is not None else float(np.linalg.norm(gaps))
    worst, unit = int(np.argmax(gaps)), model.units.length
    labels = _labels(model, block)[:count]
    names = f'loop "{labels[worst]}"'
    size = total
    if count > 1:
        names += f" (largest of {count} coupled loops, together {total:.6g} {unit})"
        size = float(gaps[worst])
    where = _inputs_text(model, inputs)
    what = (
        f"{names} cannot be closed{' at ' if where else ''}{where}: near the guess a gap of at "
        f"least {size:.6g} {unit} remains"
    )
    reach, reachable = None, True
    # a circuit of a large mechanism would take longer than anybody waits for an explanation
    if len(inputs) and solver.unknowns <= MOST_UNKNOWNS:
        lead, rate = leading_input(model.rows)
        path = InputPath(origin=inputs - rate * inputs[lead], rate=rate)
        assembled = assembled_near(model, path, lead, here)
        reachable = assembled is not None
        if assembled is not None:
            reach = reach_towards(model, path, lead, assembled, float(inputs[lead]))
    order = np.argsort(-gaps, kind="stable")
    remedies = remedies_of(model, number, here)
    if not remedies:
        what += "; change a length or start elsewhere"
    return _failure(
        model,
        inputs,
        what=what,
        loops=tuple(labels[k] for k in order),
        gap=total,
        remedies=remedies,
        reach=reach,
        unreachable=not reachable,
    )


def _inputs_text(model: Model, inputs: Array) -> str:
    return ", ".join(
        f"{variable.name} = {value / scale:.6g}"
        f"{model.units.angle.sign if variable.kind == 'angle' else ' ' + model.units.length}"
        for variable, value, scale in zip(
            model.equations.inputs, inputs, model.input_scale, strict=True
        )
    )


def _inputs_in_file_units(model: Model, inputs: Array) -> Array:
    units = model.units
    values = [
        units.angle.from_radians(float(value)) if variable.kind == "angle" else float(value)
        for variable, value in zip(model.equations.inputs, inputs, strict=True)
    ]
    return np.array(values, dtype=float)


def _failure(
    model: Model, inputs: Array, reach: ReachableRange | None = None, **parts: object
) -> Failure:
    """The explanation with the positions that exist at the inputs (p,)."""
    driven = [u.name for u in model.equations.inputs]
    found = ELSEWHERE(model, inputs)
    everywhere = model.equations.start[None, :][:0] if found is None else found.v
    n = model.compiled.solver.unknowns
    scales = np.array([model.units.scale(Kind(u.kind)) for u in model.equations.unknowns])
    turns = np.array([u.kind == "angle" for u in model.equations.unknowns], dtype=bool)
    x = everywhere[:, :n]
    # angles within half a turn, so that lists of positions can be compared
    x = np.where(turns, np.angle(np.exp(1j * np.where(turns, x, 0.0))), x) / scales
    if found is None or not found.names:
        x = np.array(sorted(x.tolist(), key=lambda row: [round(value, 6) for value in row]))
    names = [u.name for u in model.equations.unknowns]

    def by_name(values: Array) -> dict[str, float]:
        return {name: float(value) for name, value in zip(driven, values, strict=True)}

    towards: dict[str, object] = {}
    if reach is not None:
        towards = {
            "nearest_input": by_name(reach.inputs),
            "nearest_kind": reach.kind,
            "nearest_proved": reach.proved,
        }
        if not reach.kind and reach.first_dead_point is not None:
            towards["through"] = by_name(reach.first_dead_point)
    return Failure(
        asked=by_name(_inputs_in_file_units(model, inputs)),
        configurations=tuple(dict(zip(names, map(float, row), strict=True)) for row in x),
        configuration_names=() if found is None else found.names,
        complete=None if found is None else found.complete,
        complete_likely=found is not None and found.likely,
        units=model.units,
        kinds={u.name: Kind(u.kind) for u in model.equations.variables},
        **towards,  # type: ignore[arg-type]
        **parts,  # type: ignore[arg-type]
    )
