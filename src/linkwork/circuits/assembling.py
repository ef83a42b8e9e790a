"""The real solutions of a block over its unknown directions, for many closures at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from linkwork.circuits.homotopy.bilinear_homotopy import Roots
from linkwork.circuits.homotopy.counts import SolutionBound, bound_by_products
from linkwork.circuits.homotopy.dead_point_family import roots_of_two_loops
from linkwork.circuits.homotopy.isolated_roots import isolated_roots, quadratic_roots, structure_of
from linkwork.circuits.results import PathCount
from linkwork.core.equations.compiling import DirectionForm, NoDirectionForm
from linkwork.core.foundation.arrays import (
    ALMOST_DOUBLE,
    ALMOST_REAL,
    Array,
    BoolArray,
    ComplexArray,
    CountArray,
    IndexArray,
    StatusArray,
)
from linkwork.core.foundation.statuses import Completeness, Status
from linkwork.core.foundation.units import within_half_a_turn
from linkwork.core.motion.model import FITS, Model, misfit
from linkwork.core.numerics.bilinear import BilinearSystem, ProvedRoots, prove_roots
from linkwork.core.numerics.block_solver import Block, Linearised, linearise_block
from linkwork.core.numerics.newton import newton
from linkwork.core.numerics.position_proof import Proof, prove_block, rounding_of_inputs
from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import PhasorRows


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockRoots:
    """The real solutions of a block for one closure.

    ``x`` (R, 2M), with ``multiple`` (R,): those that are not regular; the ``grade`` of completeness
    and the counts of the ``paths``.
    """

    x: ComplexArray
    multiple: BoolArray
    grade: Completeness
    paths: PathCount


#: A block without loops: its only solution has no directions.
FOLLOWS = BlockRoots(
    x=np.zeros((1, 0), dtype=complex),
    multiple=np.zeros(1, dtype=bool),
    grade=Completeness.PROVED,
    paths=PathCount(unknowns=(), finite=1, real=1, expected=1),
)


def solve_block(form: DirectionForm, left: ComplexArray, off: Array) -> list[BlockRoots]:
    """The roots of a block for each of K closures (K, L, M + 1), known within ``off``."""
    if form.table.loops.rows > 1:
        return [_solve_loops(form.system(left[k]), off[k]) for k in range(len(left))]
    systems = form.system(left)
    found = quadratic_roots(systems)
    counts = [len(roots.x) for roots in found]
    of = np.repeat(np.arange(len(found)), counts)
    proofs = prove_roots(systems.take(of), np.concatenate([roots.x for roots in found]), off[of])
    bound = bound_by_products(systems.products)
    each = np.split(np.arange(len(of)), np.cumsum(counts)[:-1])
    return [_graded(roots, proofs.take(own), bound) for roots, own in zip(found, each, strict=True)]


def _solve_loops(system: BilinearSystem, off: Array) -> BlockRoots:
    """The roots of two or more loops."""
    family = structure_of(system)
    known = roots_of_two_loops(system) if system.loops == 2 else None
    roots = isolated_roots(system, family, known)
    bound = family.bound_of(system, off, len(roots.x))
    return _graded(roots, prove_roots(system, roots.x, off), bound)


def _graded(roots: Roots, proofs: ProvedRoots, bound: SolutionBound) -> BlockRoots:
    """The real ones of some roots, by their proofs."""
    m = roots.x.shape[1] // 2
    # roots that no proof decides are taken by a tolerance, and lower the grade of the list
    real = proofs.real | (~proofs.holds & (_mirror_gap(roots.x, m) < ALMOST_REAL))
    undecided = not (proofs.holds & (proofs.real | proofs.unreal)).all()
    unproved = real & ~proofs.holds
    doubles = roots.multiple[_mirror_gap(roots.multiple, m) < ALMOST_DOUBLE]
    if roots.continuum:
        grade = Completeness.CONTINUUM
    elif not (roots.sure and roots.accounted_for):
        grade = Completeness.NOT_PROVED
    elif roots.singular or unproved.any():
        grade = Completeness.MULTIPLE
    elif len(roots.x) == bound.number and proofs.apart and not undecided:
        grade = Completeness.PROVED
    else:
        grade = Completeness.WITH_PROBABILITY_ONE
    x = np.concatenate([roots.x[real], doubles])
    return BlockRoots(
        x=x,
        multiple=np.concatenate([unproved[real], np.ones(len(doubles), dtype=bool)]),
        grade=grade,
        paths=roots.counted((), len(x), bound.number, bound.theorem.value),
    )


def _mirror_gap(x: ComplexArray, m: int) -> Array:
    """How far solutions (R, 2M) are from their mirror images, relative to their size."""
    gap = np.abs(x[:, :m] - x[:, m:].conj()).max(axis=1, initial=0.0)
    relative: Array = gap / (1.0 + np.abs(x).max(axis=1, initial=0.0))
    return relative


# ----------------------------------------------------------------------
# Lengths along a turning direction that nothing else depends on: two solutions, one assembly.


@dataclass(frozen=True, kw_only=True)
class TurnedSlide:
    """An unknown angle that only directs these unknown lengths.

    (s, θ) and (-s, θ + π) are then the same assembly: no loop and no point distinguishes them.
    """

    angle: int
    lengths: tuple[int, ...]


def turned_slides(model: Model) -> tuple[TurnedSlide, ...]:
    """All of them, by block: a pair has to be solved together."""
    table = model.compiled.table
    tables = (table.loops, model.compiled.points.rows)
    tied = set(table.linear.variable.tolist())
    found = []
    for block in model.compiled.solver.blocks:
        own = set(block.unknowns.tolist())
        # an angle in a linear row determines other angles: turning it around moves them
        for angle in sorted(own - tied):
            if table.is_angle[angle]:
                lengths = _directed(tables, angle)
                if lengths and lengths <= own:
                    found.append(TurnedSlide(angle=angle, lengths=tuple(sorted(lengths))))
    return tuple(found)


def _directed(tables: tuple[PhasorRows, ...], angle: int) -> set[int]:
    """The lengths along an angle, if all its terms have one of them, and no other term has."""
    lengths: set[int] = set()
    for rows in tables:
        mine = _terms_with(rows, angle)
        if mine is None:
            return set()
        lengths |= {int(rows.length[t]) for t in mine}
    if -1 in lengths:
        return set()
    for rows in tables:
        mine = _terms_with(rows, angle) or set()
        using = {t for t, j in enumerate(rows.length) if int(j) in lengths}
        if using != mine:
            return set()
    return lengths


def _terms_with(rows: PhasorRows, angle: int) -> set[int] | None:
    """The terms that turn once with an angle; None if one turns otherwise."""
    entries = np.flatnonzero(rows.phase_variable == angle)
    if (np.abs(rows.phase_weight[entries]) != 1.0).any():
        return None
    return set(rows.phase_term[entries].tolist())


# ----------------------------------------------------------------------
# The order and the names of configurations.


_ROUND = 1e-9  # rad: angles are ordered from 0 to a full turn, this much below counts as 0
_OF_DYADS = ("open", "crossed", "double")


def order_configurations(
    block: Block,
    form: DirectionForm,
    v: Array,
    rows: IndexArray,
    sign: StatusArray,
    double: BoolArray,
    folded: bool,
) -> tuple[list[int], dict[int, str]]:
    """The documented order of a block's configurations, and their names."""
    dyad = form.table.loops.rows == 1
    single = len(form.turning) == 0 or form.rows.shape[1] == 0 or (dyad and folded)
    turns = block.system.is_angle[: len(block.unknowns)]
    own = v[:, block.unknowns]
    # an angle that is zero but for rounding is sorted as zero, not as a full turn
    angle = np.mod(own + _ROUND, 2.0 * np.pi)
    keys: list[tuple[float, ...]] = []
    names = []
    for k, values in enumerate(np.round(np.where(turns, angle, own) / _ROUND).tolist()):
        name = "" if single else "number"
        rank = 0.0
        if dyad and not single:
            name = "double" if double[k] else "open" if _is_open(form, sign[k]) else "crossed"
            rank = float(_OF_DYADS.index(name))
        names.append(name)
        keys.append((float(rows[k]), rank, *values))
    order = sorted(range(len(v)), key=keys.__getitem__)
    labels: dict[int, str] = {}
    number = {int(row): 0 for row in rows}
    for k in order:
        number[int(rows[k])] += 1
        labels[k] = str(number[int(rows[k])]) if names[k] == "number" else names[k]
    return order, labels


def _is_open(form: DirectionForm, sign: float) -> bool:
    """Which of two configurations of a dyad is called open; ``sign`` is that of det J.

    Two links: the turn from the first one to the second, head to tail, is clockwise. A link and a
    length along a known direction: the link points towards larger lengths. A length along the
    turning link: the side of larger lengths.
    """
    length_first = len(form.sliding) > 0 and form.sliding[0] < form.turning[0]
    turned = -sign if length_first else sign
    if len(form.sliding) and form.along[0] < 0:
        return turned > 0
    return turned < 0


def combined_name(labels: tuple[str, ...], number: int) -> str:
    """The name of a configuration: ``open``, ``open-crossed``, ``configuration 3``."""
    parts = [label for label in labels if label]
    if not parts:
        return f"configuration {number}"
    if len(parts) == 1 and parts[0].isdigit():
        return f"configuration {parts[0]}"
    return "-".join(parts)


# ----------------------------------------------------------------------
# All configurations at given inputs, block by block, as arrays.
#
# Every block is solved once for each configuration of the blocks before it, so the configurations
# of the whole are counted like a product.


_LARGEST = 4096  # configurations of the whole that are listed
_MOVED = 1e-5  # weighted: how far Newton's method may carry a root to its position,
_MOVED_DOUBLE = 1e-2  # and a multiple one
_SAME_POSITION = 1e-10  # weighted: two positions of a block are one
_CLOSED = 1e-12  # scaled residual at which a multiple root is a position


@dataclass(frozen=True, kw_only=True, eq=False)
class Assemblies:
    """All configurations at one input, internal units.

    Parameters
    ----------
    v : (K, N)
        Unknowns, then inputs.
    proof : Proof
        Of every position, for the rounding of its inputs.
    iterations : (K,) int
        Of Newton's method in angles and lengths, most of any block.
    names : (K,) str
        ``open``, ``open-crossed`` for several dyads, ``configuration 3`` otherwise.
    completeness, message : Completeness, str
    paths : one entry per solved block
    """

    v: Array
    proof: Proof
    iterations: CountArray
    names: tuple[str, ...]
    completeness: Completeness
    message: str
    paths: tuple[PathCount, ...]


def positions_at(model: Model, inputs: Array) -> Assemblies:
    """All real configurations of the whole mechanism at input values (p,), internal units.

    Notes
    -----
    Angles are those within half a turn of the guess. Ordered by block in solving order; inside a
    block ``open`` before ``crossed``, else by its unknowns in their order, angles from 0 to 2π.
    """
    return _Assembly(model, inputs).run()


class _Assembly:
    """Rows of partly solved positions, one block after the other."""

    def __init__(self, model: Model, inputs: Array) -> None:
        solver = model.compiled.solver
        self.model, self.solver = model, solver
        self.v = model.equations.start[None, :].copy()
        self.v[:, solver.unknowns :] = inputs
        error_bound = np.zeros_like(self.v)
        error_bound[:, solver.unknowns :] = rounding_of_inputs(self.v, solver.unknowns)
        nothing = np.zeros((1, 0))
        self.proof = Proof(
            holds=np.ones(1, dtype=bool),
            existence_radius=nothing,
            uniqueness_radius=nothing,
            error_bound=error_bound,
        )
        self.iterations = np.zeros(1, dtype=np.int64)
        self.labels: list[tuple[str, ...]] = [()]
        self.completeness = Completeness.PROVED
        self.notes: list[str] = []
        self.theorems: list[str] = []
        self.paths: list[PathCount] = []
        self.slides = turned_slides(model)

    def run(self) -> Assemblies:
        """Solve every block for every row on which redundant links fit so far."""
        for number, block in enumerate(self.solver.blocks):
            if not len(self.v):
                break
            try:
                self._add(number, block)
            except NoDirectionForm as reason:
                self._give_up(f"the equations of {', '.join(self._names(block))} {reason}")
                break
            self._keep(misfit(self.model.equations, self.v) <= FITS)  # unsolved: given values
            if len(self.v) > _LARGEST:
                self._give_up(f"there are more than {_LARGEST} of them")
                break
        if self.model.equations.redundant:
            self.notes.append("positions that do not fit a redundant link are left out")
        theorems = self.theorems if self.completeness.complete else []
        notes = [self.completeness.value, *theorems, *self.notes]
        return Assemblies(
            v=self.v,
            proof=self.proof,
            iterations=self.iterations,
            names=tuple(combined_name(labels, k + 1) for k, labels in enumerate(self.labels)),
            completeness=self.completeness,
            message="; ".join(notes),
            paths=tuple(self.paths),
        )

    def _keep(self, which: BoolArray) -> None:
        rows = np.flatnonzero(which)
        self.v, self.proof = self.v[rows], _rows_of(self.proof, rows)
        self.iterations = self.iterations[rows]
        self.labels = [self.labels[k] for k in rows]

    def _names(self, block: Block) -> tuple[str, ...]:
        return tuple(self.model.equations.unknowns[int(k)].name for k in block.unknowns)

    def _give_up(self, why: str) -> None:
        self.completeness = Completeness.NOT_LISTED
        self.notes = [why]
        self.v, self.proof = self.v[:0], _rows_of(self.proof, np.zeros(0, dtype=np.intp))
        self.iterations, self.labels = self.iterations[:0], []

    def _add(self, number: int, block: Block) -> None:
        table = block.system
        if not isinstance(table, LoopTable):
            raise NoDirectionForm("are not loops")
        if table.is_straight and (table.functions or not table.is_angle[: table.unknowns].all()):
            self._follow(block)
            return
        form = self.model.compiled.direction_form(number)
        found = _block_configurations(self.model, block, form, self.v, self.proof.error_bound)
        self.completeness = self.completeness.and_then(found.completeness)
        count = replace(found.paths, unknowns=self._names(block))
        self.paths.append(count)
        if form.table.loops.rows > 1:  # one loop is a quadratic equation
            self.theorems.append(_theorem_note(count))
        slides = [slide for slide in self.slides if slide.angle in block.unknowns]
        v = found.v
        for slide in slides:
            v = _fold_lengths(slide, v)
        keep = np.ones(len(v), dtype=bool)
        if slides:
            keep = _find_distinct(self.model, v, found.rows)
            self.notes += [self._fold_note(slide) for slide in slides if not keep.all()]
        v, rows, double = v[keep], found.rows[keep], found.multiple[keep]
        part = linearise_block(block, v)
        order, labels = order_configurations(block, form, v, rows, part.sign, double, bool(slides))
        self.iterations = np.maximum(self.iterations[rows], found.iterations[keep])[order]
        self._place(block, part, v, rows, np.array(order, dtype=np.intp))
        self.labels = [(*self.labels[rows[k]], labels[k]) for k in order]

    def _follow(self, block: Block) -> None:
        """A block that a cam or a rack determines: one configuration for each of those before."""
        done = newton(block.system, self.v[:, block.variables], self.solver.options)
        v = self.v.copy()
        v[:, block.unknowns] = done.v[:, : len(block.unknowns)]
        every = np.arange(len(v))
        self.paths.append(replace(FOLLOWS.paths, unknowns=self._names(block)))
        self._place(block, linearise_block(block, v), v, every, every)

    def _place(
        self, block: Block, part: Linearised, v: Array, rows: IndexArray, order: IndexArray
    ) -> None:
        """Take over a block's positions v with their proof, in a new order."""
        before = _rows_of(self.proof, rows)
        radii = prove_block(block, part, v, before.error_bound)
        error_bound = before.error_bound.copy()
        # later blocks cannot use an infinite bound; the missing proof is kept in holds
        error_bound[:, block.unknowns] = np.where(
            np.isfinite(radii.error_bound), radii.error_bound, 0.0
        )
        proof = Proof(
            holds=before.holds & radii.holds,
            existence_radius=np.concatenate(
                [before.existence_radius, radii.existence_radius[:, None]], axis=1
            ),
            uniqueness_radius=np.concatenate(
                [before.uniqueness_radius, radii.uniqueness_radius[:, None]], axis=1
            ),
            error_bound=error_bound,
        )
        self.v, self.proof = v[order], _rows_of(proof, order)

    def _fold_note(self, slide: TurnedSlide) -> str:
        unknowns = self.model.equations.unknowns
        length, angle = unknowns[slide.lengths[0]].name, unknowns[slide.angle].name
        return f"{length} and {angle} turned around, with {length} < 0, are the same assembly"


@dataclass(frozen=True, kw_only=True, eq=False)
class _BlockFound:
    """A block's configurations: positions (R, N), the rows they belong to, which are multiple."""

    v: Array
    rows: IndexArray
    multiple: BoolArray
    iterations: CountArray
    completeness: Completeness
    paths: PathCount


def _block_configurations(
    model: Model, block: Block, form: DirectionForm, v: Array, error_bound: Array
) -> _BlockFound:
    """A block solved for every row of v (R, N), known within ``error_bound`` (R, N)."""
    known = v[:, block.variables[len(block.unknowns) :]]
    near = model.equations.start[block.unknowns]
    if form.table.loops.rows:
        spread = error_bound[:, block.variables[len(block.unknowns) :]]
        # configurations of blocks that this one does not depend on leave its closures as they are
        closures = list(zip(*form.closures(known, spread), strict=True))
        keys = [(left.tobytes(), off.tobytes()) for left, off in closures]
        different = dict(zip(keys, closures, strict=True))
        left, off = (np.stack(part) for part in zip(*different.values(), strict=True))
        once = dict(zip(different, solve_block(form, left, off), strict=True))
        solved = [once[key] for key in keys]
    else:  # angles that follow from others without a loop
        solved = [FOLLOWS] * len(v)
    rows = np.repeat(np.arange(len(v)), [len(part.x) for part in solved])
    x = np.concatenate([part.x for part in solved])
    multiple = np.concatenate([part.multiple for part in solved])
    start = v[rows]
    start[:, block.unknowns] = form.unknowns(x, known[rows], near)
    end, good, iterations = _polish_roots(model, block, start, multiple)
    good[good] = _find_distinct(model, end[good], rows[good])
    grade = reduce(Completeness.and_then, (part.grade for part in solved))
    counts, *others = (part.paths for part in solved)
    if (~good & ~multiple).any():  # proved as directions, but not as angles and lengths
        grade = grade.and_then(Completeness.NOT_PROVED)
    return _BlockFound(
        v=end[good],
        rows=rows[good],
        multiple=multiple[good],
        iterations=iterations[good],
        completeness=grade,
        paths=replace(counts.plus(*others), real=int(good.sum())),
    )


def _polish_roots(
    model: Model, block: Block, start: Array, multiple: BoolArray
) -> tuple[Array, BoolArray, CountArray]:
    """Newton's method in angles and lengths from (R, N); which stayed at their root; iterations."""
    done = newton(block.system, start[:, block.variables], model.compiled.solver.options)
    n = len(block.unknowns)
    weights = block.system.variable_scale[:n]
    here = start[:, block.unknowns] / weights
    far = np.abs(done.v[:, :n] / weights - here).max(axis=1, initial=0.0)
    # long lengths may move further
    far /= 1.0 + np.abs(here[:, ~block.system.is_angle[:n]]).max(axis=1, initial=0.0)
    good = (done.status == Status.CONVERGED.code) & (far <= _MOVED)
    good |= multiple & (done.residual <= _CLOSED) & (far <= _MOVED_DOUBLE)
    end = start.copy()
    end[:, block.unknowns] = done.v[:, :n]
    return end, good, done.iterations


def _find_distinct(model: Model, v: Array, rows: IndexArray) -> BoolArray:
    """Which positions (R, N) are no repetition of an earlier one of the same row (ascending)."""
    size, turns = model.compiled.solver.variable_scale, model.compiled.table.is_angle
    begin, every = np.searchsorted(rows, rows), np.arange(len(v))
    # pairs of one row, by the later one
    count = every - begin
    later = np.repeat(every, count)
    earlier = np.arange(len(later)) - (np.cumsum(count) - count - begin)[later]
    gap = within_half_a_turn(v[earlier] - v[later], turns)
    equal = np.flatnonzero((np.abs(gap) <= _SAME_POSITION * size).all(axis=1))
    fresh = np.ones(len(v), dtype=bool)
    for first, second in zip(earlier[equal], later[equal], strict=True):
        fresh[second] &= not fresh[first]
    return fresh


def _theorem_note(count: PathCount) -> str:
    """The reason for a block's completeness: "a, b: 16 complex solutions, at most 16 by ..."."""
    who = ", ".join(count.unknowns)
    found = f"{count.finite} complex solution{'' if count.finite == 1 else 's'}"
    return f"{who}: {found}, at most {count.bound} by {count.theorem}"


def _rows_of(proof: Proof, rows: IndexArray) -> Proof:
    """Some rows of a proof, copied."""
    return Proof(
        holds=proof.holds[rows],
        existence_radius=proof.existence_radius[rows],
        uniqueness_radius=proof.uniqueness_radius[rows],
        error_bound=proof.error_bound[rows],
    )


def _fold_lengths(slide: TurnedSlide, v: Array) -> Array:
    """Positions (R, N) with negative lengths turned around."""
    v = v.copy()
    negative = v[:, slide.lengths[0]] < 0.0
    v[np.ix_(negative, np.array(slide.lengths))] *= -1.0
    # half a turn, towards the angles within half a turn of zero
    v[negative, slide.angle] += np.where(v[negative, slide.angle] > 0.0, -np.pi, np.pi)
    return v
