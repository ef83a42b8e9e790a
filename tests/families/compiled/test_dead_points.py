"""Dead points over lanes, and the proof that the arc to each belongs to the branch."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from linkwork.core.table.loop_table import LoopTable
from linkwork.core.table.rows import LinearRows, PhasorRows
from linkwork.families.march import dead_points as folding
from linkwork.families.march.dead_points import LastNodes, dead_points

Array = npt.NDArray[np.float64]
#: A crank r with a rod l, driven by the slider x: r e^(it) + l e^(ip) - x = 0, a dead point at
#: x = r + l with t = p = 0.
R, L = 1.0, 1.03


def slider_crank() -> LoopTable:
    rows = PhasorRows(
        rows=1,
        variables=3,
        row=np.array([0, 0, 0]),
        coefficient=np.array([R, L, -1.0], dtype=complex),
        length=np.array([-1, -1, 2]),
        phase_term=np.array([0, 1]),
        phase_variable=np.array([0, 1]),
        phase_weight=np.array([1.0, 1.0]),
    )
    return LoopTable(
        unknowns=2,
        loops=rows,
        linear=LinearRows.none(),
        functions=(),
        equation_scale=np.full(2, L),
        variable_scale=np.array([1.0, 1.0, L]),
        is_angle=np.array([True, True, False]),
    )


def node(crank: Array) -> tuple[Array, Array, Array]:
    """Unknowns (2, D), their rates by x, and x where the crank has some angles."""
    rod = -np.arcsin(R * np.sin(crank) / L)
    x = R * np.cos(crank) + L * np.cos(rod)
    rod_by_crank = -R * np.cos(crank) / (L * np.cos(rod))
    slope = 1.0 / (-R * np.sin(crank) - L * np.sin(rod) * rod_by_crank)
    return np.stack([crank, rod]), np.stack([slope, slope * rod_by_crank]), x


def located(crank: Array, off: Array | float = 0.0, error: float = 1e-12) -> Array:
    """The dead point ahead of cranks, the rods of the nodes moved by ``off``."""
    w, s, x = node(crank)
    before, slope, _ = node(1.05 * crank)
    nodes = LastNodes(
        t=x,
        w=w + off * np.array([[0.0], [1.0]]),
        s=s,
        q=before,
        p=slope,
        x=np.full_like(w, error),
    )
    given = {"c0.re": R, "c1.re": L, "c2.re": -1.0, "scale2": L}
    coefficients = {name: np.full(len(crank), value) for name, value in given.items()}
    zeros = {f"c{k}.im" for k in range(3)}
    return dead_points(slider_crank(), zeros, coefficients, nodes, 1)


def test_longer_arcs_are_proved_in_more_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    crank = np.linspace(-2.0, -0.001, 200)
    counts = []
    for parts in ((), (2,), (2, 4), (2, 4, 8)):
        monkeypatch.setattr(folding, "_PARTS", parts)
        t = located(crank)
        found = np.isfinite(t)
        np.testing.assert_allclose(t[found], R + L, rtol=1e-14)
        counts.append(int(found.sum()))
    assert 0 < counts[0] < counts[1] < counts[2]
    assert counts[2] <= counts[3] <= len(crank)


def test_an_arc_from_another_branch_is_never_proved() -> None:
    # the rod the other way: for the same crank the only other place, at the far end of the guide
    crank = np.linspace(-2.0, -0.001, 200)
    other = np.pi - 2.0 * node(crank)[0][1]
    assert not np.isfinite(located(crank, off=other)).any()
    assert np.isfinite(located(crank)).sum() > 100


def test_what_is_not_known_of_the_node_shortens_the_arc() -> None:
    crank = np.linspace(-2.0, -0.001, 200)
    exact, vague = (np.isfinite(located(crank, error=error)).sum() for error in (1e-12, 0.3))
    assert 0 < vague < exact
    assert not np.isfinite(located(crank, error=2.0)).any()
