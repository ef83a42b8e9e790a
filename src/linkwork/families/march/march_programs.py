"""Programs that compute rates, condition and residual at positions, and prove these.

Block by block, as in ``numerics.block_solver``:  J x' = -F_u u',  J x'' = -D²F[(x', u'), (x', u')]
with the rates of all variables that a block knows. Registers by name:

``v<k>``             variables, the inputs after the unknowns
``u<j>.rate``        rate of an input by the leading one
``scale<k>``         weights of variables that are lengths
``length``           scale of the residuals of equations of lengths
``first<k>`` ``second<k>``  derivatives of the unknowns by the leading input
``condition``        the largest ‖J‖·‖J⁻¹‖ of all blocks, weighted, in the largest norm
``residual``         the largest residual of all equations, scaled
``u<j>.spread``      how far an input may be from its true value, besides its rounding
``radius`` ``unique``  a position lies within the first, no other one within the second, weighted;
                     both NaN where that is not proved
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.foundation.arrays import UNIT_ROUNDOFF, Array, IndexArray
from linkwork.core.record.block_proof import BlockProof
from linkwork.core.record.closure import (
    BlockPart,
    Closure,
    Phase,
    add_rates,
    condition_of,
    cosine_and_sine,
    driven,
    phasor_name,
    solve_linear,
    weight_of,
)
from linkwork.core.record.printing import Body, Language
from linkwork.core.record.recorder import (
    ROLES,
    Program,
    Recorder,
    Registers,
    Value,
    lower_program,
    reserve,
)
from linkwork.core.table.loop_table import LoopTable

Number = Value | float


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaceProgram:
    """A program that computes ``wanted`` named registers from a position."""

    program: Program
    registers: Registers
    wanted: tuple[str, ...]


class PlaceWriter:
    """Writes programs that compute quantities of a position.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        Blocks in the order in which they are solved.
    zeros : set of str
        Names of coefficients that are zero in every design.
    """

    def __init__(
        self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str] = frozenset()
    ) -> None:
        self.table, self.n = table, table.unknowns
        self.rec = rec = Recorder()
        variables = [rec.input(f"v{k}") for k in range(table.variables)]
        self.closures = [Closure(table, part, rec, variables, zeros) for part in parts]

    def finish(self, wanted: Sequence[str]) -> PlaceProgram:
        """The program, which computes these registers."""
        registers = Registers()
        reserve(self.rec, registers)
        program = lower_program(self.rec, registers, registers.count)
        return PlaceProgram(program=program, registers=registers, wanted=tuple(wanted))

    def derivatives(self) -> tuple[Mapping[int, Number], Mapping[int, Number]]:
        """Both derivatives of all variables by the leading input."""
        inputs = range(self.table.variables - self.n)
        alone = len(inputs) == 1  # a single input leads
        first: dict[int, Number] = {
            self.n + j: 1.0 if alone else self.rec.input(f"u{j}.rate") for j in inputs
        }
        second: dict[int, Number] = {self.n + j: 0.0 for j in inputs}
        for closure in self.closures:
            add_rates(closure, first, second)
        return first, second

    def rates(self) -> list[str]:
        """Write the first derivatives of all unknowns, then the second ones; the registers."""
        written = {
            f"{name}{k}": by_variable[k]
            for name, by_variable in zip(("first", "second"), self.derivatives(), strict=True)
            for k in range(self.n)
        }
        for name, value in written.items():
            self.rec.write(name, value)
        return list(written)

    def condition(self, lengths: Set[int]) -> list[str]:
        """The largest condition; ``lengths``: the linear rows that are equations of lengths."""
        rec = self.rec
        found = [condition_of(c, self._scales(c, lengths))[0] for c in self.closures]
        rec.write("condition", rec.largest([1.0, *found]))
        return ["condition"]

    def residual(self, lengths: Set[int]) -> list[str]:
        """The largest residual, scaled."""
        rec = self.rec
        residuals = [rec.constant(0.0)]
        for closure in self.closures:
            residuals += [
                rec.divide(rec.absolute(f), scale)
                for f, scale in zip(closure.residual(), self._scales(closure, lengths), strict=True)
            ]
        rec.write("residual", rec.largest(residuals))
        return ["residual"]

    def _scales(self, closure: Closure, lengths: Set[int]) -> list[Number]:
        """Of the residuals of a block."""
        length = self.rec.input("length")
        lines = [length if r in lengths else 1.0 for r in closure.lines]
        return [*[length] * (2 * len(closure.loops)), *lines]


# ----------------------------------------------------------------------
# The programs of one topology: predict, solve block by block, prove or judge the step.
#
# A lane keeps five positions: the trial (role 0) and the last four nodes (roles 1 to 4). Registers
# by name, one number per lane each; ``.s`` is a role:
#
# ``t.s``                   the value of the path
# ``x<k>.s`` ``d<k>.s``     unknowns, and their derivatives by t
# ``e<k>.s``                how far the true position may be from there
# ``side<b>.s``             det J of a block
# ``u<j>.origin`` ``.rate`` inputs are u = origin + rate t
# ``u<j>.spread``           how far the inputs of a row may be from those, besides their rounding
# ``a1`` … ``b4``           weights of the nodes' unknowns and derivatives in the prediction
# ``scale<k>``              weights of variables that are lengths
#
# and registers of the trial that keep their places when roles move on:
#
# ``u<j>.0``                inputs; phasors of phases that only inputs turn
# ``live<b>.0``             1.0 where block b still iterates
# ``step<b>.0`` ``begin<b>.0``  weighted size of the latest and of the first correction
# ``y<k>.0``                how far the true position may get from the trial on the way to it
# ``radius.0``              the largest error of the trial, weighted
# ``good.0``                1.0 where the step may be taken
#
# When the trial has become the last node, roles move on by one: nothing is copied, the same program
# is run with its registers renamed (:meth:`MarchPrograms.turned`).


STEPS = 6  # of Newton-Raphson for one block of a trial
START_STEPS = 50  # of Newton-Raphson for one block, from a guess


@dataclass(frozen=True, kw_only=True)
class Steps:
    """How lanes step: sizes in t, tolerances as weighted changes.

    ``tolerance``: below it a Newton-Raphson step is the last one; the error left is about its
    square. ``most_correction``, ``most_drift``: without proofs, the largest first correction and
    change of rates times step that are trusted.
    """

    first: float = 0.05
    largest: float = 0.6
    smallest: float = 1e-5
    tolerance: float = 1e-8
    most_turn: float = float(np.radians(40.0))
    most_correction: float = 0.1
    most_drift: float = 0.5

    @property
    def sizes(self) -> Array:
        """The first, the largest and the smallest step."""
        return np.array([self.first, self.largest, self.smallest])

    def times(self, size: float) -> Steps:
        """For a path whose natural step is this many times longer: a length for lengths."""
        return replace(
            self,
            first=size * self.first,
            largest=size * self.largest,
            smallest=size * self.smallest,
        )


#: Numbers of :class:`Steps` that programs read.
OPTIONS = ("tolerance", "most_turn", "most_correction", "most_drift")
NODES = ROLES - 1  # that a prediction can use
#: Registers of the weights of nodes' values and derivatives in a prediction.
WEIGHTS = tuple(f"{name}{role}" for role in range(1, ROLES) for name in "ab")


@dataclass(frozen=True, kw_only=True, eq=False)
class MarchPrograms:
    """Programs ``by_kind``, in the order in which the march counts them: ``predict`` the trial; the
    inputs ``given`` there; ``judge``; of every block ``begin``, ``damped`` at the start,
    ``iterate``, and ``prove`` if asked.

    ``nodes`` (5, S): registers of positions by role, the first ones of all. ``noted``: names of
    further results of a trial; ``shared``: those of the given registers that depend on t alone,
    none where they depend on the design as well.
    """

    registers: Registers
    height: int
    by_kind: Mapping[str, tuple[Program, ...]]
    nodes: IndexArray
    noted: tuple[str, ...]
    shared: tuple[str, ...]

    @property
    def sections(self) -> tuple[Program, ...]:
        """All programs in their order."""
        return tuple(program for programs in self.by_kind.values() for program in programs)

    def turned(self, moves: int) -> tuple[Program, ...]:
        """The sections when roles have moved on this many times: the trial is one further down."""
        place = np.arange(self.height, dtype=np.uint32)
        for role in range(ROLES):
            place[self.nodes[role]] = self.nodes[(role - moves) % ROLES]
        return tuple(
            replace(program, code=np.hstack([program.code[:, :1], place[program.code[:, 1:]]]))
            for program in self.sections
        )


class _MarchWriter:
    """Records the programs of one table."""

    def __init__(
        self, table: LoopTable, parts: Sequence[BlockPart], zeros: Set[str], certified: bool
    ) -> None:
        self.table, self.parts, self.zeros, self.certified = table, parts, zeros, certified
        self.n, self.count = table.unknowns, table.variables
        self.alone = self.count == self.n + 1  # a single input is the path's own value

    def _variables(self, rec: Recorder) -> list[Value]:
        """All variables at the trial."""
        inputs = range(self.count - self.n)
        own = [rec.input("t.0")] if self.alone else [rec.input(f"u{j}.0") for j in inputs]
        return [*[rec.input(f"x{k}.0") for k in range(self.n)], *own]

    def _rate(self, rec: Recorder, j: int) -> Value:
        """By how much an input changes with t."""
        return rec.constant(1.0) if self.alone else rec.input(f"u{j}.rate")

    def _rate_of_known(self, rec: Recorder, k: int) -> Value:
        """The rate of a variable that a block takes as known."""
        return rec.input(f"d{k}.0") if k < self.n else self._rate(rec, k - self.n)

    def _weigh(self, rec: Recorder, k: int, change: Value) -> Value:
        """|change| of a variable in its weight."""
        return rec.divide(rec.absolute(change), weight_of(rec, self.table, k))

    def _closure(self, number: int, rec: Recorder) -> Closure:
        part = self.parts[number]
        return Closure(self.table, part, rec, self._variables(rec), self.zeros, shared=True)

    def predict(self) -> Recorder:
        """The polynomial through the last nodes with their derivatives."""
        rec = Recorder()
        for k in range(self.n):
            value: Value = rec.constant(0.0)
            for role in range(1, ROLES):
                value = value + rec.input(f"a{role}") * rec.input(f"x{k}.{role}")  # eq. (18)
                value = value + rec.input(f"b{role}") * rec.input(f"d{k}.{role}")
            rec.write(f"x{k}.0", value)
        return rec

    def given(self) -> Recorder:
        """The inputs at t, and the phasors that only they turn."""
        rec = Recorder()
        t = rec.input("t.0")
        inputs = [t]
        if not self.alone:
            inputs = [
                rec.input(f"u{j}.origin") + rec.input(f"u{j}.rate") * t
                for j in range(self.count - self.n)
            ]
            for j, value in enumerate(inputs):
                rec.write(f"u{j}.0", value)
        variables = [t] * self.n + inputs  # phases of inputs alone know no unknowns
        for phase in sorted(self._given_phases()):
            cosine, sine = cosine_and_sine(rec, variables, phase)
            rec.write(phasor_name("cos", phase), cosine)
            rec.write(phasor_name("sin", phase), sine)
        return rec

    def _given_phases(self) -> set[Phase]:
        closures = [self._closure(b, Recorder()) for b in range(len(self.parts))]
        return {p for c in closures for p in c.phases.values() if c.given(p)}

    def iterate(self, number: int, first: bool, damped: bool) -> Recorder:
        """One Newton-Raphson step of a block; without proofs with rates and the sign of det J."""
        part, rec = self.parts[number], Recorder()
        closure = self._closure(number, rec)
        matrix, sides = closure.jacobian(part.unknowns), [closure.residual()]
        if not self.certified:
            given = {k: self._rate_of_known(rec, k) for k in closure.known()}
            sides.append(driven(closure, given))  # eq. (11), right side
        answer = solve_linear(rec, matrix, sides)
        change, live = answer.columns[0], rec.input(f"live{number}.0")
        turns = [
            abs(d) for d, k in zip(change, part.unknowns, strict=True) if self.table.is_angle[k]
        ]
        if damped and turns:
            factor = rec.smallest([1.0, rec.input("most_turn") / rec.largest(turns)])  # eq. (7)
            change = [factor * d for d in change]
        size = rec.largest(
            self._weigh(rec, k, d) for d, k in zip(change, part.unknowns, strict=True)
        )

        def put(name: str, value: Value) -> None:
            rec.write(name, value if first else rec.where(live, value, rec.input(name)))

        for d, k in zip(change, part.unknowns, strict=True):
            put(f"x{k}.0", closure.v[k] - d)  # eq. (6)
        for moved in answer.columns[1:]:
            rates = self._rates(closure, matrix, moved, change)
            for r, k in zip(rates, part.unknowns, strict=True):
                put(f"d{k}.0", r)
        if not self.certified:
            put(f"side{number}.0", answer.determinant)
            put(f"step{number}.0", size)
            if first:
                rec.write(f"begin{number}.0", size)
        done = rec.at_most(size, rec.input("tolerance"))  # eq. (8)
        rec.write(f"live{number}.0", 1.0 - done if first else rec.where(done, 0.0, live))
        return rec

    def _rates(
        self,
        closure: Closure,
        matrix: Sequence[Sequence[Value | float]],
        moved: Sequence[Value],
        change: Sequence[Value],
    ) -> list[Value]:
        """Rates after the correction, from those before it: the Jacobian is not solved again."""
        rec, unknowns = closure.rec, closure.part.unknowns
        rates = {k: self._rate_of_known(rec, k) for k in closure.known()}
        rates |= {k: -r for k, r in zip(unknowns, moved, strict=True)}
        correction = {k: -d for k, d in zip(unknowns, change, strict=True)}
        # eq. (12): how rates change along the correction
        (more,) = solve_linear(rec, matrix, [closure.bending(correction, rates)]).columns
        return [rec.subtract(rates[k], m) for k, m in zip(unknowns, more, strict=True)]

    def prove(self, number: int) -> Recorder:
        """A block's proof: of the trial, and that it lies on the branch of the last node."""
        part, rec = self.parts[number], Recorder()
        closure = self._closure(number, rec)
        proof = BlockProof(closure)
        near: dict[int, Value] = {}
        far: dict[int, Value] = {}
        # the factor covers the rounding of the difference and of the inputs at both ends
        step = abs(rec.input("t.0") - rec.input("t.1")) * (1.0 + 16.0 * UNIT_ROUNDOFF)
        for k in proof.known:
            if k < self.n:
                near[k], far[k] = rec.input(f"e{k}.0"), rec.input(f"y{k}.0")
            else:
                near[k] = abs(closure.v[k]) * (4.0 * UNIT_ROUNDOFF) + rec.input(
                    f"u{k - self.n}.spread"
                )
                # all inputs of the step, from both rounded ends
                far[k] = step * abs(self._rate(rec, k - self.n)) + 2.0 * near[k]
        for k, rate in zip(part.unknowns, proof.rates(self._rate_of_known), strict=True):
            rec.write(f"d{k}.0", rate)
        here, there = proof.within(near), proof.within(far)
        masks = [here.holds, there.holds]
        for k, error, reach, alone in zip(
            part.unknowns, here.error_bound, there.error_bound, there.isolation_radius, strict=True
        ):
            rec.write(f"e{k}.0", error)
            rec.write(f"y{k}.0", reach)
            away = abs(closure.v[k] - rec.input(f"x{k}.1"))
            away = away + rec.largest([error, rec.input(f"e{k}.1")])
            masks.append(rec.at_most(away, alone * (1.0 - 4.0 * UNIT_ROUNDOFF)))  # eq. (33)
        rec.write(f"ok{number}.0", rec.all_of(masks))
        rec.write(f"radius{number}.0", here.radius)
        return rec

    def judge_proof(self) -> Recorder:
        """``good``: where everything is proved."""
        rec = Recorder()
        blocks = range(len(self.parts))
        masks = [rec.input(f"ok{b}.0") for b in blocks]
        # a trial that has not converged may be proved, but with a uselessly large radius
        masks += [rec.at_most(rec.input(f"live{b}.0"), 0.0) for b in blocks]
        rec.write("good.0", rec.all_of(masks))
        rec.write("radius.0", rec.largest(rec.input(f"radius{b}.0") for b in blocks))
        return rec

    def judge(self) -> Recorder:
        """``good``: where the step may be taken without a proof."""
        rec = Recorder()
        masks = []
        for b in range(len(self.parts)):
            masks.append(rec.at_most(rec.input(f"step{b}.0"), rec.input("tolerance")))
            masks.append(rec.at_most(rec.input(f"begin{b}.0"), rec.input("most_correction")))
            # det J keeps its sign along a branch
            product = rec.input(f"side{b}.0") * rec.input(f"side{b}.1")
            masks.append(rec.at_most(0.0, product))
        h = rec.input("t.0") - rec.input("t.1")
        drifts = [
            # eq. (23) without the second derivative: a coarser bound
            self._weigh(rec, k, (rec.input(f"d{k}.0") - rec.input(f"d{k}.1")) * h)
            for k in range(self.n)
        ]
        masks.append(rec.at_most(rec.largest(drifts), rec.input("most_drift")))
        rec.write("good.0", rec.all_of(masks))
        return rec

    def node_names(self, role: int) -> list[str]:
        """Registers of a position in a role: unknowns, derivatives, evidence, t."""
        own = [f"{name}{k}" for name in "xd" for k in range(self.n)]
        own += [f"e{k}" for k in range(self.n)] if self.certified else []
        own += [] if self.certified else [f"side{b}" for b in range(len(self.parts))]
        return [f"{name}.{role}" for name in (*own, "t")]


def march_programs(
    table: LoopTable,
    parts: Sequence[BlockPart],
    zeros: Set[str] = frozenset(),
    certified: bool = False,
) -> MarchPrograms:
    """The programs of a table in blocks.

    Parameters
    ----------
    table : LoopTable
        Without function rows.
    parts : sequence of BlockPart
        Blocks in the order in which they are solved.
    zeros : set of str
        Names of coefficients that are zero in every design.
    certified : bool
        Whether every step is proved.
    """
    writer, blocks = _MarchWriter(table, parts, zeros, certified), range(len(parts))
    recorded = {
        "predict": [writer.predict()],
        "given": [writer.given()],
        "judge": [writer.judge_proof() if certified else writer.judge()],
        "begin": [writer.iterate(b, first=True, damped=False) for b in blocks],
        "damped": [writer.iterate(b, first=False, damped=True) for b in blocks],
        "iterate": [writer.iterate(b, first=False, damped=False) for b in blocks],
        "prove": [writer.prove(b) for b in blocks if certified],
    }
    every = [rec for recorders in recorded.values() for rec in recorders]
    registers = Registers()
    nodes = np.stack([registers.all_of(writer.node_names(role)) for role in range(ROLES)])
    noted = {name for rec in every for name in rec.writes} | {"good.0", "radius.0"}
    noted -= set(writer.node_names(0))
    registers.all_of(sorted(noted))
    for rec in every:
        reserve(rec, registers)
    by_kind = {
        kind: tuple(lower_program(rec, registers, registers.count) for rec in recorders)
        for kind, recorders in recorded.items()
    }
    heights = [program.height for programs in by_kind.values() for program in programs]
    return MarchPrograms(
        registers=registers,
        height=max(registers.count, *heights),
        by_kind=by_kind,
        nodes=nodes,
        noted=tuple(sorted(noted)),
        shared=tuple(recorded["given"][0].writes) if writer.alone else (),
    )


# ----------------------------------------------------------------------
# The programs of a march printed as functions of one mechanism's state, in any language.


@dataclass(frozen=True, kw_only=True)
class ThreadState:
    """The registers that a march keeps, laid out as in :class:`linkwork.families.gpu.march.Shape`.

    Parameters
    ----------
    place : Mapping[int, int]
        By register.
    coefficients, options : tuple of str
        Names of registers that are filled before a program runs.
    blocks : int
    """

    place: Mapping[int, int]
    coefficients: tuple[str, ...]
    options: tuple[str, ...]
    blocks: int

    @classmethod
    def of(
        cls, programs: MarchPrograms, options: Sequence[str], fixed: Collection[str] = ()
    ) -> ThreadState:
        """The state that the programs of a topology need; ``options``: names that may be read,
        ``fixed``: coefficients that are written as numbers.
        """
        named, blocks = programs.registers.named, len(programs.by_kind["begin"])
        own = {*programs.nodes.ravel().tolist(), *(named[name] for name in programs.noted)}
        noted = ["good.0", "radius.0", *(f"live{b}.0" for b in range(blocks))]
        more = [name for name in programs.noted if name not in noted]
        known = {*WEIGHTS, *fixed}
        given = [name for name in named if named[name] not in own and name not in known]
        coefficients = tuple(name for name in given if name not in options)
        used = tuple(name for name in options if name in named)
        order = [named[name] for name in (*WEIGHTS, *noted, *coefficients, *used, *more)]
        order = [*programs.nodes.ravel().tolist(), *order]
        place = {register: k for k, register in enumerate(order)}
        return cls(place=place, coefficients=coefficients, options=used, blocks=blocks)


def printed_sections(
    programs: MarchPrograms,
    state: ThreadState,
    language: Language,
    fixed: Mapping[str, float] | None = None,
) -> Iterator[str]:
    """Functions ``reach``, ``given``, ``agree``, and ``begin``, ``damped``, ``iterate``, ``prove``
    of each block, of the state ``w``.

    Parameters
    ----------
    fixed : Mapping[str, float], optional
        Coefficients that are written as numbers.
    """
    whole = {"predict": "reach", "given": "given", "judge": "agree"}
    named = {
        whole.get(kind, f"{kind}{b}"): program
        for kind, by_block in programs.by_kind.items()
        for b, program in enumerate(by_block)
    }
    registers = programs.registers
    constants = {register: value for value, register in registers.constants.items()}
    constants |= {
        registers.named[name]: value
        for name, value in (fixed or {}).items()
        if name in registers.named
    }
    for name, program in named.items():
        body = Body(lambda register: f"w[{state.place[register]}]", constants, language)
        body.add(program.code)
        body.end(state.place.keys())
        yield language.written(name, ["w"], body.lines)
