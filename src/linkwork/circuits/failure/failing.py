"""Classify why Newton-Raphson missed the intended position."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from linkwork.circuits.failure.reach import (
    MOST_UNKNOWNS,
    ReachableRange,
    assembled_near,
    block_positions,
    distance,
    positions_elsewhere,
    reach_towards,
    roots_in_block,
)
from linkwork.circuits.failure.remedies import remedies_of
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.statuses import NewtonTrouble, Status
from linkwork.core.foundation.units import within_half_a_turn
from linkwork.core.motion.following import turns_freely
from linkwork.core.motion.model import Model, leading_input
from linkwork.core.numerics.block_solver import Block
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.kantorovich import excluded
from linkwork.core.numerics.newton import NewtonOptions, nearest_miss, newton
from linkwork.core.numerics.position_proof import prove, rounding_of_inputs
from linkwork.core.results.failure import Failure, Limit
from linkwork.core.results.quantity import Kind

_CLOSED = 1e-10  # scaled residual of a position
_FLAT = 1e-8  # of its natural size: a slope or curvature that is zero
_SHRINKS = 0.4  # ratio of steps from which on a root may be multiple: 1/2 for a double one
_HIGHEST_ORDER = 100  # of a root that steps are taken to lead to
_ASIDE = 0.5  # of the way from the root to the guess, where the bending is compared


@dataclass(frozen=True, kw_only=True, eq=False)
class Miss:
    """Where a damped iteration ends: ``v`` in the block's order, unscaled residuals ``f`` (m,),
    ``closed`` if that is a position after all.
    """

    v: Array
    f: Array
    closed: bool

    @property
    def known(self) -> bool:
        """Whether the equations have values there."""
        return bool(np.isfinite(self.f).all())


def miss_of(block: Block, v: Array) -> Miss:
    """The block as near to closure as a damped iteration from v (N,) gets."""
    nearest, f = nearest_miss(block.system, v[block.variables])
    closed = np.isfinite(f).all() and np.abs(f / block.system.equation_scale).max() <= _CLOSED
    if closed and block.system.is_enclosed:
        closed = roots_in_block(block, nearest[None, :])[0]
    return Miss(v=nearest, f=f, closed=bool(closed))


@dataclass(frozen=True, kw_only=True, eq=False)
class DoubtfulRoot:
    """Formulas that are small where no root is proved: ``f`` (m,) unscaled.

    ``free``: half width (n,) of a box without a root, 0 if none is known. ``order`` of a multiple
    root as the last steps of Newton-Raphson suggest, 0 if they do not; it would be at about
    ``away`` (n,).
    """

    f: Array
    free: Array
    order: int
    away: Array


def doubtful_root(block: Block, start: Array, found: Array, options: NewtonOptions) -> DoubtfulRoot:
    """What is known of a place ``found`` (N,) that Newton-Raphson reached from ``start`` (N,).

    Near a root of order m steps shrink by 1 - 1/m, so that m times the next step leads there.
    """
    n, steps = len(block.unknowns), []
    weights = block.system.variable_scale[:n]

    def watch(_: int, x: Array, residual: Array, change: Array | None) -> None:
        if change is not None:
            steps.append(change[0])

    newton(block.system, start[block.variables][None, :], options, watch)
    order, away = 0, np.zeros(n)
    if len(steps) > 1:
        last, before = (float(np.abs(step / weights).max()) for step in (steps[-1], steps[-2]))
        ratio = last / before
        if _SHRINKS < ratio < 1.0 - 1.0 / _HIGHEST_ORDER:
            order = round(1.0 / (1.0 - ratio))
            away = order * ratio * np.abs(steps[-1])
    here = found[block.variables]
    free = excluded(block.system, here) * weights
    return DoubtfulRoot(
        f=block.system.residual(here[None, :])[0], free=free, order=order, away=away
    )


def trouble_of(
    block: Block, v: Array, status: Status, miss: Miss, options: NewtonOptions
) -> NewtonTrouble | None:
    """Why Newton-Raphson failed on a block from v (N,), where a position exists; ``None``: other.

    - stopped where J is singular: an extremum if F lies across the range of J and bends there,
      else a singular derivative;
    - the damped iteration is held where Jᵀ F = 0, F ≠ 0: a local extremum;
    - it finds a root near which the equations bend both ways, and Newton's steps grew: an
      inflection.
    """
    iterates: list[Array] = []
    sizes: list[float] = []
    n = len(block.unknowns)
    weights = block.system.variable_scale[:n]

    def watch(k: int, x: Array, residual: Array, change: Array | None) -> None:
        iterates.append(x[0].copy())
        if change is not None:
            sizes.append(float(np.abs(change[0] / weights).max()))

    newton(block.system, v[block.variables][None, :], options, watch)
    if status is Status.SINGULAR_JACOBIAN:
        extremum = _is_extremum(block, iterates[-1])
        return NewtonTrouble.LOCAL_EXTREMUM if extremum else NewtonTrouble.SINGULAR_DERIVATIVE
    if not miss.closed:
        return NewtonTrouble.LOCAL_EXTREMUM if miss.known else None
    grew = sum(b > a for a, b in pairwise(sizes))
    # around an inflection Newton-Raphson swings with growing steps
    if 2 * grew > len(sizes) - 1 and _bends_both_ways(block, miss.v, v[block.variables]):
        return NewtonTrouble.INFLECTION
    return None


def _is_extremum(block: Block, v: Array) -> bool:
    """Whether |F| is stationary at v (N,) and bends along the null direction of J."""
    system, n = block.system, len(block.unknowns)
    weights, scale = system.variable_scale[:n], system.equation_scale
    f, jacobian = (part[0] for part in system.residual_and_jacobian(v[None, :]))
    r, j = f / scale, jacobian[:, :n] * weights / scale[:, None]
    if not (np.isfinite(r).all() and np.isfinite(j).all()):
        return False
    size = float(np.linalg.norm(r))
    # at a singular J that is no extremum F has a part within the range of J
    if not size or np.linalg.norm(j.T @ r) > _FLAT * size:
        return False
    _, _, right = np.linalg.svd(j)
    direction = np.zeros_like(v)
    direction[:n] = right[-1] * weights
    bend = system.second_directional_derivative(v[None, :], direction[None, :])[0] / scale
    return bool(abs(r @ bend) > _FLAT * size)


def _bends_both_ways(block: Block, root: Array, guess: Array) -> bool:
    """Whether J⁻¹ D²F[d, d] points to opposite sides before and after the root on the line d."""
    system, n = block.system, len(block.unknowns)
    d = np.zeros_like(root)
    d[:n] = guess[:n] - root[:n]
    sides = np.stack([root + _ASIDE * d, root - _ASIDE * d])
    bends = system.second_directional_derivative(sides, np.stack([d, d]))
    try:
        inverse = np.linalg.inv(system.jacobian(root[None, :])[0, :, :n])
    except np.linalg.LinAlgError:
        return False
    before, behind = (inverse @ bend / system.variable_scale[:n] for bend in bends)
    return bool(before @ behind < 0.0)


def root_beside_guess(block: Block, guess: Array, found: Array) -> Array | None:
    """The position (n,) that was meant where another one was found; ``None`` if it was found.

    A root was passed over if det J has another sign at the root found than at the guess, and one
    with the guess's sign lies nearer to the guess. Both ``guess`` and ``found`` (N,) hold the
    known variables as solved.
    """
    n = len(block.unknowns)
    ends = np.stack([guess[block.variables], found[block.variables]])
    weights, scale = block.system.variable_scale[:n], block.system.equation_scale
    slopes = block.system.jacobian(ends)[:, :, :n] * weights / scale[:, None]
    # divided by the size of J, so that the limit of flatness has no unit
    with np.errstate(all="ignore"):  # J may vanish or overflow: then it has no sign
        signs = np.linalg.det(slopes) / np.linalg.norm(slopes, axis=(1, 2)) ** n
    if not (np.abs(signs) > _FLAT).all() or signs[0] * signs[1] > 0.0:
        return None
    others, _ = block_positions(block, guess)
    start = guess[block.unknowns]
    reached = distance(block, start, found[block.unknowns])
    for x in sorted(others, key=lambda x: distance(block, start, x)):
        if distance(block, start, x) >= reached * (1.0 - 1e-9):
            return None
        there = guess[block.variables].copy()
        there[:n] = x
        if np.linalg.det(block.system.jacobian(there[None, :])[0, :, :n]) * signs[0] > 0.0:
            return np.asarray(x)
    return None


# ----------------------------------------------------------------------
# Explain a failed position: open loops, remedies, nearest reachable input.


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
    what = status.value
    if trouble is not None:
        what = f"{what.partition(':')[0]}: {trouble.value}"
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
    what = "the motion starts at the input value of the guess, where there is no position"
    kept = ["loops", "gap", "remedies", "trouble", "meant"]
    here = _failure(model, inputs, what=f"{what}: {failure.what}")
    if not here.configurations:
        kept += ["nearest_input", "nearest_kind", "nearest_proved", "through", "unreachable"]
    return replace(here, **{name: getattr(failure, name) for name in kept})


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
    total = float(np.linalg.norm(gaps))
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
    found = positions_elsewhere(model, inputs)
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
        driven = (variable.name for variable in model.equations.inputs)
        return dict(zip(driven, map(float, values), strict=True))

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
