"""Programs that find the dead point ahead of a node: there the path's value turns back.

With another variable in the lead (parameter λ, the fastest one near the dead point), the path's
value t is an unknown like the others, and the dead point is where dt/dλ = 0: found by the secant
method on the curve. Registers as in :mod:`march_programs`, and

``lead0`` ``slope0``   λ and dt/dλ at the place before
``bend``               d²t/dλ² between the last two places
``move``               the weighted size of the last change of λ
``seeking``            1.0 while the place is still improved
``w<k>`` ``x<k>``      the place that an arc is proved from, and how far the true one may be
``e<k>``               how far the true place may be from where the arc was proved to
``p<k>`` ``pr<k>``     the node with its rates by λ; ``z<k>`` ``zr<k>`` the dead point with its own
``along``              which part of the way from the node to the dead point a place between has
``sound``              1.0 where the place reached is proved, wherever it was reached from
``side``               -1.0 or 1.0, on which side of the place ``w`` another one is tried
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, BoolArray, IndexArray
from linkwork.core.record.block_proof import BlockProof
from linkwork.core.record.closure import BlockPart, Closure, solve_linear, weight_of
from linkwork.core.record.recorder import (
    LANES,
    Code,
    Recorder,
    Registers,
    lower_program,
    reserve,
)
from linkwork.core.table.loop_table import LoopTable
from linkwork.families.compiled.compiling import compiled, compiled_within
from linkwork.families.compiled.interpreter import run

_CLEARLY = 32.0  # twice as many errors of t as lie between a dead point and the places aside
_LEAST = 1e-9  # weighted: the nearest of them
_FARTHEST = 0.3  # weighted: how far λ may go in one step


@dataclass(frozen=True, kw_only=True, eq=False)
class FoldPrograms:
    """``iterate``: Newton-Raphson at a fixed λ with the rates by λ; ``move``: to the next λ.

    ``prove``: the arc from ``w`` to the place reached. For proofs in parts ``between`` predicts a
    place between node and dead point; after ``advance`` the next part begins at the place reached.
    ``aside``: a place so far from ``w`` that t, which turns back there, differs by more than its
    error.
    """

    registers: Registers
    height: int
    code: Mapping[str, Code]


class _FoldWriter:
    def __init__(self, table: LoopTable, lead: int, zeros: Set[str]) -> None:
        self.table, self.lead, self.zeros = table, lead, zeros
        self.n = table.unknowns
        equations = tuple(range(table.loops.rows + len(table.linear.constant)))
        others = tuple(k for k in range(self.n + 1) if k != lead)
        self.part = BlockPart(equations=equations, unknowns=others)

    def _closure(self, rec: Recorder) -> Closure:
        variables = [rec.input(f"v{k}") for k in range(self.n + 1)]
        return Closure(self.table, self.part, rec, variables, self.zeros)

    def iterate(self) -> Recorder:
        """One step with λ held, and the rates of the others by λ."""
        rec = Recorder()
        closure = self._closure(rec)
        drives = [row[0] for row in closure.jacobian([self.lead])]
        matrix = closure.jacobian(self.part.unknowns)
        change, moved = solve_linear(rec, matrix, [closure.residual(), drives]).columns
        live, sizes = rec.input("live"), []
        for d, r, k in zip(change, moved, self.part.unknowns, strict=True):
            sizes.append(rec.divide(rec.absolute(d), closure.scale(k)))
            rec.write(f"v{k}", rec.where(live, closure.v[k] - d, closure.v[k]))
            rec.write(f"r{k}", rec.where(live, -r, rec.input(f"r{k}")))
        size = rec.largest(sizes)
        rec.write("step", rec.where(live, size, rec.input("step")))
        done = rec.at_most(size, rec.input("tolerance"))
        rec.write("live", rec.where(done, 0.0, live))
        return rec

    def move(self) -> Recorder:
        """The next λ by the secant method, the others along their rates."""
        rec = Recorder()
        here, before = rec.input(f"v{self.lead}"), rec.input("lead0")
        slope, slope0 = rec.input(f"r{self.n}"), rec.input("slope0")
        seeking = rec.input("seeking")
        bend = (slope - slope0) / (here - before)  # eq. (37)
        far = _FARTHEST * weight_of(rec, self.table, self.lead)
        wanted = -(slope / bend)  # eq. (37)
        # far from the dead point the secant may lead out of the arc
        change = rec.largest([rec.smallest([wanted, far]), -far])
        moved = rec.divide(rec.absolute(change), weight_of(rec, self.table, self.lead))
        rec.write("bend", rec.where(seeking, bend, rec.input("bend")))
        rec.write("move", rec.where(seeking, moved, rec.input("move")))
        rec.write("lead0", rec.where(seeking, here, before))
        rec.write("slope0", rec.where(seeking, slope, slope0))
        rec.write(f"v{self.lead}", rec.where(seeking, here + change, here))
        for k in self.part.unknowns:
            v = rec.input(f"v{k}")
            rec.write(f"v{k}", rec.where(seeking, v + rec.input(f"r{k}") * change, v))
        close = rec.at_most(moved, rec.input("close"))
        rec.write("seeking", rec.where(close, 0.0, seeking))
        return rec

    def prove(self) -> Recorder:
        """Prove that the place reached lies on the curve of the previous one (first: the node)."""
        rec = Recorder()
        closure = self._closure(rec)
        proof = BlockProof(closure)
        here, node = closure.v[self.lead], rec.input(f"w{self.lead}")
        near = rec.absolute(here) * (4.0 * UNIT_ROUNDOFF)
        # a node's own λ is known as well as its position
        away = rec.absolute(here - node) * (1.0 + 16.0 * UNIT_ROUNDOFF)
        far = away + 2.0 * near + rec.input(f"x{self.lead}")
        place = proof.within(dict.fromkeys(proof.known, near))
        arc = proof.within(dict.fromkeys(proof.known, far))
        rec.write("sound", rec.where(place.holds, 1.0, 0.0))
        masks = [place.holds, arc.holds]
        for k, error, alone in zip(
            self.part.unknowns, place.error_bound, arc.isolation_radius, strict=True
        ):
            rec.write(f"e{k}", error)
            off = rec.absolute(closure.v[k] - rec.input(f"w{k}"))
            known = rec.largest([error, rec.input(f"x{k}")])
            masks.append(rec.at_most(off + known, alone * (1.0 - 4.0 * UNIT_ROUNDOFF)))  # eq. (33)
        rec.write("good", rec.all_of(masks))
        return rec

    def between(self) -> Recorder:
        """A place between node and dead point: the cubic through both with their rates."""
        rec = Recorder()
        s = rec.input("along")
        square, cube = s * s, s * s * s
        away = rec.input(f"z{self.lead}") - rec.input(f"p{self.lead}")
        ahead = 3.0 * square - 2.0 * cube
        rise, fall = (cube - 2.0 * square + s) * away, (cube - square) * away
        rec.write(f"v{self.lead}", rec.input(f"p{self.lead}") + s * away)
        for k in self.part.unknowns:
            begin, end = rec.input(f"p{k}"), rec.input(f"z{k}")
            bent = rise * rec.input(f"pr{k}") + fall * rec.input(f"zr{k}")
            rec.write(f"v{k}", begin + ahead * (end - begin) + bent)  # eq. (19)
        return rec

    def advance(self) -> Recorder:
        """The next part begins where this one ended, at a λ that is exact."""
        rec = Recorder()
        rec.write(f"w{self.lead}", rec.input(f"v{self.lead}"))
        rec.write(f"x{self.lead}", 0.0)
        for k in self.part.unknowns:
            rec.write(f"w{k}", rec.input(f"v{k}"))
            rec.write(f"x{k}", rec.input(f"e{k}"))
        return rec

    def aside(self) -> Recorder:
        """A place near ``w``: t there differs by half of ``bend`` times the distance squared."""
        rec = Recorder()
        bend = rec.absolute(rec.input("bend"))
        away = rec.sqrt(rec.divide(_CLEARLY * rec.input(f"x{self.n}"), bend))
        here = rec.input(f"w{self.lead}")
        least = _LEAST * weight_of(rec, self.table, self.lead)
        away = rec.largest([away, least])
        rec.write(f"v{self.lead}", here + rec.input("side") * away)
        for k in self.part.unknowns:
            rec.write(f"v{k}", rec.input(f"w{k}"))
        return rec


def fold_programs(table: LoopTable, lead: int, zeros: Set[str] = frozenset()) -> FoldPrograms:
    """The programs of a table with a single input, led by one of its unknowns.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    lead : int
        The unknown that leads.
    """
    writer = _FoldWriter(table, lead, zeros)
    names = ("iterate", "move", "prove", "between", "advance", "aside")
    recorded: dict[str, Recorder] = {name: getattr(writer, name)() for name in names}
    registers = Registers()
    for rec in recorded.values():
        reserve(rec, registers)
    programs = {
        name: lower_program(rec, registers, registers.count) for name, rec in recorded.items()
    }
    return FoldPrograms(
        registers=registers,
        height=max(registers.count, *(program.height for program in programs.values())),
        code={name: program.code for name, program in programs.items()},
    )


# ----------------------------------------------------------------------
# Dead points of many designs at once.


_PLACES = 30  # that the secant method may try
_STEPS = 8  # of Newton-Raphson at each
_CLOSE = 1e-7  # a move of λ after which the place is found: t is off by its square and less
_TOLERANCE = 1e-8  # of the last Newton-Raphson step: the error left is its square, near rounding
_PARTS = (2, 4, 8)  # that an arc is proved in where it is not proved in one
# A t with a larger relative error bound is corrected with exact residuals, design by design. A few
# hundred roundings, so that few designs need it; empirical, any value near it serves.
_EXACT = 5e-14
_STRAIGHT = 1e-4  # weighted d²t/dλ² below which it is no ordinary dead point


@dataclass(frozen=True, kw_only=True, eq=False)
class LastNodes:
    """The last nodes of D designs: ``t`` (D,), unknowns ``w`` (n, D), their derivatives ``s`` with
    respect to t, both at the node before (``q``, ``p``), and error bounds ``x`` of ``w``.
    """

    t: Array
    w: Array
    s: Array
    q: Array
    p: Array
    x: Array


def dead_points(
    table: LoopTable,
    zeros: Set[str],
    coefficients: Mapping[str, Array],
    nodes: LastNodes,
    way: int,
) -> Array:
    """The dead point right ahead of every node, downwards (way 0) or upwards (1), t (D,); NaN where
    none is proved to be one, and joined to the node.

    Parameters
    ----------
    table : LoopTable
        Without function rows, with a single input.
    coefficients : Mapping[str, (D,)]
        By register.
    """
    n, count = nodes.w.shape
    scale = np.stack([coefficients.get(f"scale{k}", np.ones(count)) for k in range(n)])
    with np.errstate(invalid="ignore"):
        leads = np.argmax(np.abs(nodes.s) / scale, axis=0)  # eq. (35)
    t = np.full(count, np.nan)
    for lead in np.unique(leads):
        mine = np.flatnonzero(leads == lead)
        t[mine] = _led_by(table, int(lead), zeros, coefficients, nodes, mine, way)
    return np.where((t >= nodes.t) if way else (t <= nodes.t), t, np.nan)


def _led_by(
    table: LoopTable,
    lead: int,
    zeros: Set[str],
    coefficients: Mapping[str, Array],
    nodes: LastNodes,
    mine: IndexArray,
    way: int,
) -> Array:
    """The dead points of designs that the same unknown leads to them."""
    programs = fold_programs(table, lead, zeros)
    n = table.unknowns
    own = {name: values[mine] for name, values in coefficients.items()}
    at_node = _at_node(nodes, lead, mine)
    others = [k for k in range(n + 1) if k != lead]
    named = ["step", "move", "bend", "live", "seeking", "good", "sound"]
    named += [*(f"v{k}" for k in range(n + 1)), *(f"{r}{k}" for k in others for r in "re")]
    out = _Runner(programs, own | at_node).solved("move", _PLACES, named)
    size = own.get(f"scale{lead}", np.ones(len(mine)))
    with np.errstate(invalid="ignore"):
        fine = (out["live"] == 0.0) & (out["seeking"] == 0.0) & (out["sound"] > 0.5)
        fine &= (out["step"] <= _TOLERANCE) & (out["move"] <= _CLOSE)
        fine &= np.abs(out["bend"]) * size**2 >= _STRAIGHT
    proved = out["good"] > 0.5
    both = own | at_node | _both_ends(at_node, out, lead, others)
    for parts in _PARTS:
        left = np.flatnonzero(fine & ~proved)
        some = _Runner(programs, {name: values[left] for name, values in both.items()})
        proved[left] = some.proved_in(parts)
    fine &= proved
    left = np.flatnonzero(fine)
    fine[left] = _turns(programs, own, out, lead, others, left, way)
    left = np.flatnonzero(fine & (out[f"e{n}"] > _EXACT * np.maximum(1.0, np.abs(out[f"v{n}"]))))
    for k in left:
        v = np.array([out[f"v{j}"][k] for j in range(n + 1)])
        out[f"v{n}"][k] = _exact(table, {name: values[k] for name, values in own.items()}, v, lead)
    return np.where(fine, out[f"v{n}"], np.nan)


def _turns(
    programs: FoldPrograms,
    coefficients: Mapping[str, Array],
    dead: Mapping[str, Array],
    lead: int,
    others: Sequence[int],
    left: IndexArray,
    way: int,
) -> BoolArray:
    """Whether t is proved to turn back at some places: on both sides it is less far than there."""
    n, sign = len(others), 1.0 if way else -1.0
    given = {name: values[left] for name, values in coefficients.items()}
    given |= {f"w{k}": dead[f"v{k}"][left] for k in (lead, *others)}
    given |= {f"x{k}": dead[f"e{k}"][left] for k in others}
    given |= {f"x{lead}": np.zeros(len(left)), "bend": dead["bend"][left]}
    t, error = given[f"w{n}"], given[f"x{n}"]
    turns = np.ones(len(left), dtype=bool)
    for side in (-1.0, 1.0):
        runner = _Runner(programs, given | {"side": np.full(len(left), side)})
        beside = runner.solved("aside", 1, ["good", f"v{n}", f"e{n}"])
        with np.errstate(invalid="ignore"):
            # eq. (40) by values of t instead of its rates
            turns &= sign * (t - beside[f"v{n}"]) > error + beside[f"e{n}"]
        turns &= beside["good"] > 0.5
    return turns


def _exact(table: LoopTable, coefficients: Mapping[str, float], v: Array, lead: int) -> float:
    """The last variable of a position of one design (n + 1,), corrected to rounding."""
    loops, lines = table.loops, table.linear
    factors = np.array([
        complex(*(coefficients.get(f"c{term}.{part}", 0.0) for part in ("re", "im")))
        for term in range(len(loops.row))
    ])  # fmt: skip
    constants = [coefficients.get(f"k{row}", 0.0) for row in range(len(lines.constant))]
    own = replace(
        table,
        loops=replace(loops, coefficient=factors),
        linear=replace(lines, constant=np.array(constants)),
    )
    slopes = np.delete(own.jacobian(v[None, :])[0], lead, axis=1)
    return float(v[-1] - np.linalg.solve(slopes, own.exact_residual(v)[0])[-1])


def _at_node(nodes: LastNodes, lead: int, mine: np.ndarray) -> dict[str, Array]:
    """Registers at the nodes of some designs: places, rates by λ, bounds of the errors."""
    n = len(nodes.w)
    # dt/dλ is the reciprocal of the leader's rate by t
    slope, slope0 = 1.0 / nodes.s[lead, mine], 1.0 / nodes.p[lead, mine]
    data = {f"v{k}": nodes.w[k, mine] for k in range(n)}
    data |= {f"w{k}": nodes.w[k, mine] for k in range(n)}
    data |= {f"x{k}": nodes.x[k, mine] for k in range(n)} | {f"x{n}": np.zeros(len(mine))}
    data |= {f"r{k}": nodes.s[k, mine] * slope for k in range(n)}
    data |= {f"v{n}": nodes.t[mine], f"w{n}": nodes.t[mine], f"r{n}": slope}
    return data | {"lead0": nodes.q[lead, mine], "slope0": slope0}


def _both_ends(
    node: Mapping[str, Array], dead: Mapping[str, Array], lead: int, others: Sequence[int]
) -> dict[str, Array]:
    """Registers of an arc: its node and its dead point, with rates by λ."""
    data: dict[str, Array] = {}
    for end, place, rate in ((node, "p", "pr"), (dead, "z", "zr")):
        data |= {f"{place}{k}": end[f"v{k}"] for k in (lead, *others)}
        data |= {f"{rate}{k}": end[f"r{k}"] for k in others}
    return data


class _Runner:
    """Programs with their data, ``given`` (D,) by register, and a workspace."""

    def __init__(self, programs: FoldPrograms, given: Mapping[str, Array]) -> None:
        self.programs, self.registers = programs, programs.registers
        named = self.registers.named
        names = [name for name in given if name in named]
        self.places = np.array([named[name] for name in names], dtype=np.intp)
        self.given = np.stack([given[name] for name in names])
        self.space = self.registers.filled(programs.height, LANES)
        self.space[named["tolerance"]], self.space[named["close"]] = _TOLERANCE, _CLOSE

    def solved(self, first: str, most: int, wanted: Sequence[str]) -> dict[str, Array]:
        """Registers (D,) after a program has chosen at most so many places, each solved, and the
        arc to the last one was tried in one.
        """
        code = self.programs.code
        out = np.empty((len(wanted), self.given.shape[1]))
        live, seeking = self.registers.all_of(["live", "seeking"])
        _solve_places(
            code[first], code["iterate"], code["prove"], self.space, live, seeking, most,
            self.registers.all_of(wanted), self.places, self.given, out,
        )  # fmt: skip
        return dict(zip(wanted, out, strict=True))

    def proved_in(self, parts: int) -> BoolArray:
        """Whether this many parts prove the arcs, (D,)."""
        code, proved = self.programs.code, np.zeros(self.given.shape[1], dtype=bool)
        live, good, along = self.registers.all_of(["live", "good", "along"])
        _prove_in_parts(
            code["between"], code["iterate"], code["prove"], code["advance"], self.space, live,
            good, along, self.places, self.given, parts, proved,
        )  # fmt: skip
        return proved


@compiled_within
def _is_zero(w: Array, row: int) -> bool:
    total = 0.0
    for i in range(LANES):
        total += w[row, i]
    return total == 0.0


@compiled_within
def _solve(iterate: Code, w: Array, live: int) -> None:
    w[live, :] = 1.0
    for _ in range(_STEPS):
        run(iterate, w)
        if _is_zero(w, live):
            break


@compiled_within
def _load(w: Array, places: IndexArray, given: Array, base: int) -> None:
    """The designs from ``base`` on; the last one in lanes that are left."""
    for lane in range(LANES):
        member = min(base + lane, given.shape[1] - 1)
        for j in range(len(places)):
            w[places[j], lane] = given[j, member]


@compiled_within
def _store(w: Array, wanted: IndexArray, base: int, out: Array) -> None:
    """Columns of ``out`` from ``base`` on, as many as it has."""
    for lane in range(min(LANES, out.shape[1] - base)):
        for j in range(len(wanted)):
            out[j, base + lane] = w[wanted[j], lane]


@compiled
def _solve_places(
    first: Code,
    iterate: Code,
    prove: Code,
    w: Array,
    live: int,
    seeking: int,
    most: int,
    wanted: IndexArray,
    places: IndexArray,
    given: Array,
    out: Array,
) -> None:
    """LANES designs at a time: places chosen by the first program and solved, until none is sought
    or there were ``most`` of them; the proof of the arc to the last one.
    """
    count = given.shape[1]
    for base in range(0, count, LANES):
        _load(w, places, given, base)
        w[seeking, :] = 1.0
        for _ in range(most):
            run(first, w)
            _solve(iterate, w, live)
            if _is_zero(w, seeking):
                break
        run(prove, w)
        _store(w, wanted, base, out)


@compiled
def _prove_in_parts(
    between: Code,
    iterate: Code,
    prove: Code,
    advance: Code,
    w: Array,
    live: int,
    good: int,
    along: int,
    places: IndexArray,
    given: Array,
    parts: int,
    proved: BoolArray,
) -> None:
    """Places between node and dead point, each proved to lie on the curve of the previous place."""
    count = given.shape[1]
    for base in range(0, count, LANES):
        _load(w, places, given, base)
        lanes = min(LANES, count - base)
        proved[base : base + lanes] = True
        for part in range(1, parts + 1):
            w[along, :] = part / parts
            run(between, w)
            _solve(iterate, w, live)
            run(prove, w)
            for lane in range(lanes):
                proved[base + lane] &= w[good, lane] > 0.5 and w[live, lane] == 0.0
            run(advance, w)
