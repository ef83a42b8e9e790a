"""The referee of single certificates: every constant and every claim against ball arithmetic."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
from flint import arb

from linkwork.core.numerics.kantorovich import Bounds, Majorant, Radii, expansion, weighted_radii
from linkwork.core.table.loop_table import LoopTable
from tests.campaigns.positions import Placed
from tests.core.numerics.proof_bounds import bounds
from tests.oracles.balls import BallTable, ball, certainly_above, exactly, newton

__all__ = ["Case", "Verdict", "judge", "judge_case"]

Array = npt.NDArray[np.float64]


@dataclass
class Verdict:
    """What was looked at, and every claim that turned out to be false."""

    counts: Counter[str] = field(default_factory=Counter)
    false: list[str] = field(default_factory=list)

    def add(self, other: Verdict) -> None:
        """Both together."""
        self.counts += other.counts
        self.false += other.false


@dataclass(frozen=True)
class Case:
    """A position with its certificate: A, the uncertainty of the known variables, the claims."""

    placed: Placed
    balls: BallTable
    v: Array
    matrix: Array
    known: Array
    bounds: Bounds
    radii: Radii

    @property
    def n(self) -> int:
        return self.placed.table.unknowns

    @property
    def weights(self) -> Array:
        return np.asarray(self.placed.table.variable_scale[: self.n])

    def with_known(self, shift: Array) -> Array:
        """v with the known variables moved by fractions of their uncertainty."""
        moved = self.v.copy()
        moved[self.n :] += shift * self.known
        return moved

    def place(self, shift: Array) -> list[arb]:
        """The same in balls, not rounded."""
        exact = exactly(self.v)
        return exact[: self.n] + [
            x + arb(float(s)) * arb(float(k))
            for x, s, k in zip(exact[self.n :], shift, self.known, strict=True)
        ]


def judge(positions: Iterable[Placed], seed: int, starts: int = 40) -> Verdict:
    """Referee the certificates of many positions; ``starts``: Newton starts for other roots."""
    rng = np.random.default_rng([9, seed])
    verdict = Verdict()
    for number, placed in enumerate(positions):
        case = _case(rng, placed, number)
        if case is None:
            verdict.counts["J singular to rounding"] += 1
            continue
        judge_case(rng, case, starts, verdict, f"{placed.kind}, seed {seed}, position {number}: ")
    return verdict


def _case(rng: np.random.Generator, placed: Placed, number: int) -> Case | None:
    table = placed.table
    n = table.unknowns
    v = placed.v.copy()
    if number % 2:  # not quite at the root
        v[:n] += 10 ** rng.uniform(-14, -2) * rng.normal(size=n) * table.variable_scale[:n]
    jacobian = table.jacobian(v[None, :])
    try:
        matrix = np.asarray(np.linalg.inv(jacobian[0, :, :n]), dtype=float)
    except np.linalg.LinAlgError:
        return None
    if number % 7 == 3:  # any approximate inverse will do
        matrix = matrix * (1 + 10 ** rng.uniform(-8, -1) * rng.normal(size=matrix.shape))
    known = np.zeros(len(v) - n)
    if number % 4 in (1, 2):
        size = (
            10 ** rng.uniform(-14, 0.3, len(known)) if number % 8 < 4 else 10 ** rng.uniform(-6, -2)
        )
        known = size * table.variable_scale[n:] * (rng.random(len(known)) < 0.8)
    if number % 3 == 2:  # in fitted weights, as a step is proved
        place = expansion(table, v[None, :], jacobian, matrix[None])
        weights = table.variable_scale.copy()
        fitted = Majorant(place, known[None, :]).fit_weights(weights[:n])[0]
        weights[:n] = fitted / (fitted / weights[:n]).max()  # their ratios are what matters
        table = replace(table, variable_scale=weights)
        placed = replace(placed, table=table)
    claimed = bounds(table, v[None, :], jacobian, matrix[None], known[None, :])
    return Case(
        placed=placed,
        balls=BallTable(table),
        v=v,
        matrix=matrix,
        known=known,
        bounds=claimed,
        radii=weighted_radii(claimed, table.variable_scale[:n]),
    )


def judge_case(
    rng: np.random.Generator, case: Case, starts: int, verdict: Verdict, where: str
) -> None:
    """Referee one position; without ``starts`` only whether a root is where one is claimed."""

    def false(claim: str) -> None:
        verdict.false.append(where + claim)

    verdict.counts["positions"] += 1
    p = len(case.known)
    corner = rng.choice([-1.0, 1.0], p)
    shifts = [np.zeros(p)]
    if case.known.any():
        shifts += [corner, -corner, rng.uniform(-1, 1, p)]
        verdict.counts["uncertain inputs"] += 1
    if starts:
        _constants(rng, case, shifts, false)
        _lipschitz(rng, case, shifts, false)
    if not case.radii.holds[0]:
        verdict.counts["not proved"] += 1
        return
    verdict.counts["proved"] += 1
    exact = None
    for shift in shifts:
        root, proved = newton(case.balls, case.place(shift))
        if not proved:
            false("no root where one is proved")
            continue
        exact = root if exact is None else exact
        _radii(case, root, false)
    if exact is not None and starts:
        _alone(rng, case, exact, starts, verdict, false)


def _constants(rng: np.random.Generator, case: Case, shifts: list[Array], false: object) -> None:
    """Y, Z0 exactly evaluated at known values inside their intervals; ω at x0 in closed form."""
    assert callable(false)
    b, w = case.bounds, case.balls.weights
    for shift in shifts:
        at = case.place(shift)
        step = case.balls.reduced_residual(at, case.matrix)
        defect = case.balls.defect(at, case.matrix)
        for i in range(case.n):
            if certainly_above(abs(step[i]) / w[i], b.y[0, i]):
                false(f"Y of row {i} is larger than {b.y[0, i]}")
            if certainly_above(defect[i], b.z[0, i]):
                false(f"Z0 of row {i} is larger than {b.z[0, i]}")
        for still, slope in [case.balls.modulus_bound(at, case.matrix)]:
            for i in range(case.n):
                if certainly_above(still[i], b.omega[0, i]):
                    false(f"ω of row {i} is larger than {b.omega[0, i]}")
                if certainly_above(slope[i], b.omega_slope[0, i]):
                    false(f"ω's growth of row {i} is larger than {b.omega_slope[0, i]}")
    shift = shifts[int(rng.integers(len(shifts)))]
    rho = float(10 ** rng.uniform(-4, 0.5))
    at = case.place(shift)
    for k in range(case.n):  # a corner of the ball of radius ρ
        at[k] += float(rng.choice([-1, 1])) * arb(rho) * w[k]
    for i, bend in enumerate(case.balls.bend(at, case.matrix)):
        if bend > arb(float(b.omega[0, i])) + arb(rho) * arb(float(b.omega_slope[0, i])):
            false(f"second derivatives of row {i} within {rho} are larger than ω")


def _lipschitz(rng: np.random.Generator, case: Case, shifts: list[Array], false: object) -> None:
    """‖A (J(x) - J(y))‖ ≤ ω(ρ) ‖x - y‖ at random pairs within ρ, in floats."""
    assert callable(false)
    n, table, w = case.n, case.placed.table, case.weights
    pairs = 32
    rho = 10 ** rng.uniform(-3, 0.5, (pairs, 1))
    base = case.with_known(shifts[int(rng.integers(len(shifts)))])
    x = np.repeat(base[None, :], pairs, axis=0)
    y = x.copy()
    x[:, :n] += rho * w * rng.uniform(-1, 1, (pairs, n))
    y[:, :n] += rho * w * rng.uniform(-1, 1, (pairs, n))
    y[::2, :n] = x[::2, :n] + 1e-3 * (y[::2, :n] - x[::2, :n])  # near each other, too
    j_x, j_y = (table.jacobian(z)[:, :, :n] for z in (x, y))
    rows = (np.abs(case.matrix @ (j_x - j_y)) * w).sum(axis=2) / w
    far = np.abs((x - y)[:, :n] / w).max(axis=1, keepdims=True)
    omega = case.bounds.omega[0] + rho * case.bounds.omega_slope[0]
    # rounding of the two Jacobians and of large angles
    size = (np.abs(case.matrix) @ np.abs(j_x) * w).sum(axis=2) / w
    rounding = 1e-14 * size * (1 + np.abs(base[table.is_angle.nonzero()]).max(initial=0.0))
    if not (rows <= omega * far * (1 + 1e-9) + rounding).all():
        false("A J changes faster than ω")


def _radii(case: Case, root: list[arb], false: object) -> None:
    """The true root lies within r- and within the radius of each unknown."""
    assert callable(false)
    for k in range(case.n):
        off = abs(root[k] - arb(float(case.v[k])))
        if not off <= arb(float(case.radii.existence_radius[0])) * case.balls.weights[k]:
            false(
                f"unknown {k} is {float(off.mid())} away, "
                f"beyond r- = {case.radii.existence_radius[0]}"
            )
        if not off <= arb(float(case.radii.error_bound[0, k])):
            false(f"unknown {k} is {float(off.mid())} away, beyond {case.radii.error_bound[0, k]}")


def _alone(
    rng: np.random.Generator,
    case: Case,
    root: list[arb],
    starts: int,
    verdict: Verdict,
    false: object,
) -> None:
    """No second root within r+: J is regular in balls halfway out, and Newton finds no other."""
    assert callable(false)
    n, table, w = case.n, case.placed.table, case.weights
    unique = float(case.radii.uniqueness_radius[0])
    here = np.array([float(x.mid()) for x in root])
    inside = min(unique, 1e3)
    # I - A J contracts up to (1 - Z0)/ω, which is r+ at least halved; balls are a little wider
    half = 0.35 * inside
    zeros = np.zeros(len(case.known))
    box = case.place(zeros)
    box = [x + ball(0, half * float(wk)) for x, wk in zip(box[:n], w, strict=True)] + box[n:]
    if half < 0.5:
        verdict.counts["boxes without a second root"] += 1
        if not all(row < 1 for row in case.balls.defect(box, case.matrix)):
            false(f"J may be singular within {half} although r+ = {unique}")
    v = np.repeat(case.v[None, :], starts, axis=0)
    reach = np.where(np.arange(starts) < starts // 2, inside, 4.0)[:, None]
    v[:, :n] += reach * w * rng.uniform(-1, 1, (starts, n))
    v[0, :n] = case.v[:n] + 0.999 * inside * w * rng.choice([-1, 1], n)
    for _ in range(40):
        v[:, :n] -= _newton_step(table, v)
    last = np.abs(_newton_step(table, v) / w).max(axis=1)
    far = np.abs((v[:, :n] - here[:n]) / w).max(axis=1)
    from_centre = np.abs((v - case.v)[:, :n] / w).max(axis=1)
    other = (last < 1e-9) & (far > 1e-5 * max(unique, 1e-9)) & (far > 1e3 * last)
    verdict.counts["other roots found"] += int(other.sum())
    for row in np.flatnonzero(other & (from_centre < unique * (1 - 1e-9))):
        second, proved = newton(case.balls, exactly(v[row, :n]) + case.place(zeros)[n:])
        off = max(
            abs(a - arb(float(b))) / c
            for a, b, c in zip(second[:n], case.v, case.balls.weights, strict=False)
        )
        apart = max(abs(a - b) for a, b in zip(second[:n], root[:n], strict=True))
        if proved and apart > arb(2) ** -100 and off < arb(unique):
            false(f"a second root {float(off.mid())} away although r+ = {unique}")


def _newton_step(table: LoopTable, v: Array) -> Array:
    n = table.unknowns
    f, j = table.residual_and_jacobian(v)
    with np.errstate(all="ignore"):
        j = j[:, :, :n] + 1e-300
        try:
            step = np.linalg.solve(j, f[:, :, None])[:, :, 0]
        except np.linalg.LinAlgError:
            step = np.stack(
                [np.linalg.lstsq(a, b, rcond=None)[0] for a, b in zip(j, f, strict=False)]
            )
    return np.asarray(np.clip(np.nan_to_num(step, nan=1.0, posinf=1.0, neginf=-1.0), -1e3, 1e3))
