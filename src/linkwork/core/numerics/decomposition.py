"""Block-triangular form: which equations determine which unknowns, and in which order.

Maximum bipartite matching of equations to unknowns, then strong components of the dependence
graph (Duff, Erisman & Reid, Direct Methods for Sparse Matrices, ch. 6; Dulmage & Mendelsohn 1958).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count as counter

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.numerics.block_solver import Block, BlockSolver


@dataclass(frozen=True, kw_only=True)
class BlockForm:
    """The square blocks in solving order, and the parts that are not square.

    ``blocks`` : (equations, unknowns) per block. ``overdetermined`` : equations of the part with
    more equations than unknowns. ``underdetermined`` : unknowns of the part with more unknowns.
    ``conflict_unknowns`` : the unknowns in the overdetermined part; ``surplus`` and ``missing``
    count by how many real equations each part is off.
    """

    blocks: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]
    overdetermined: tuple[int, ...] = ()
    conflict_unknowns: tuple[int, ...] = ()
    underdetermined: tuple[int, ...] = ()
    surplus: int = 0
    missing: int = 0

    @property
    def square(self) -> bool:
        """Whether every unknown is determined by the blocks."""
        return not self.surplus and not self.missing


def block_form(pattern: Sequence[Sequence[int]], count: Sequence[int], unknowns: int) -> BlockForm:
    """Decompose equations into irreducible blocks.

    Parameters
    ----------
    pattern : sequence of sequences of int
        The unknowns (0 … unknowns-1) in each equation.
    count : sequence of int
        Real rows per equation: 2 for a complex loop, 1 for a real equation. Rows of one equation
        stay in one block.
    unknowns : int

    Notes
    -----
    O(rows · √rows) for the matching, linear for the rest.
    """
    owner = [e for e, rows in enumerate(count) for _ in range(rows)]
    columns = [pattern[e] for e in owner]
    row_of, column_of = _matching(columns, unknowns)
    users: list[list[int]] = [[] for _ in range(unknowns)]
    for row, used in enumerate(columns):
        for column in used:
            users[column].append(row)
    unmatched = (row for row, column in enumerate(column_of) if column < 0)
    over_rows, over_columns = _reach(unmatched, columns, row_of)
    unmatched = (column for column, row in enumerate(row_of) if row < 0)
    under_columns, _ = _reach(unmatched, users, column_of)
    graph: list[set[int]] = [set() for _ in pattern]
    for row, used in enumerate(columns):
        for column in used:
            other = row_of[column]
            # an edge from a block to the block that determines what it uses
            if other >= 0 and owner[other] != owner[row]:
                graph[owner[row]].add(owner[other])
    rows_of: list[list[int]] = [[] for _ in pattern]
    for row, equation in enumerate(owner):
        rows_of[equation].append(row)
    finished = tuple(
        (
            equations,
            tuple(sorted(column_of[r] for e in equations for r in rows_of[e] if column_of[r] >= 0)),
        )
        for equations in (tuple(sorted(c)) for c in _strong_components(graph))
    )
    return BlockForm(
        blocks=finished,
        overdetermined=tuple(sorted({owner[row] for row in over_rows})),
        conflict_unknowns=tuple(sorted(over_columns)),
        underdetermined=tuple(sorted(under_columns)),
        surplus=sum(1 for column in column_of if column < 0),
        missing=sum(1 for row in row_of if row < 0),
    )


def _matching(columns: Sequence[Sequence[int]], unknowns: int) -> tuple[list[int], list[int]]:
    """A largest matching: (row of each column, column of each row), -1 where unmatched."""
    row_of = [-1] * unknowns
    column_of = [-1] * len(columns)
    # greedy start, rows with fewest entries first; nearly everything is matched by it
    for row in sorted(range(len(columns)), key=lambda r: len(columns[r])):
        for column in columns[row]:
            if row_of[column] < 0:
                row_of[column], column_of[row] = row, column
                break
    for row in range(len(columns)):
        if column_of[row] < 0:
            _augment(row, columns, row_of, column_of)
    return row_of, column_of


def _augment(
    root: int, columns: Sequence[Sequence[int]], row_of: list[int], column_of: list[int]
) -> None:
    """Match one more row by the shortest alternating path to a free column, if there is one."""
    came: dict[int, int] = {}  # the row from which a column was reached
    queue = deque([root])
    while queue:
        row = queue.popleft()
        for column in columns[row]:
            if column in came:
                continue
            came[column] = row
            if row_of[column] >= 0:
                queue.append(row_of[column])
                continue
            while column >= 0:
                row = came[column]
                row_of[column], column, column_of[row] = row, column_of[row], column
            return


def _reach(
    begin: Iterable[int], neighbours: Sequence[Sequence[int]], partner: Sequence[int]
) -> tuple[set[int], set[int]]:
    """What alternating paths reach: on the side of their beginnings, and on the other side.

    ``partner``: the matched one of each on the other side, -1 where there is none.
    """
    found = set(begin)
    across: set[int] = set()
    queue = deque(found)
    while queue:
        for there in neighbours[queue.popleft()]:
            back = partner[there]
            if there not in across and back >= 0 and back not in found:
                found.add(back)
                queue.append(back)
            across.add(there)
    return found, across


def _strong_components(graph: Sequence[set[int]]) -> list[list[int]]:
    """Tarjan 1972, without recursion; a component comes after those it depends on."""
    unseen, finished = -1, len(graph)
    index = [unseen] * len(graph)
    low = [unseen] * len(graph)
    stack: list[int] = []
    work: list[tuple[int, Iterator[int]]] = []
    found: list[list[int]] = []
    numbers = counter()

    def enter(node: int) -> None:
        index[node] = low[node] = next(numbers)
        stack.append(node)
        work.append((node, iter(sorted(graph[node]))))

    for root in range(len(graph)):
        if index[root] == unseen:
            enter(root)
        while work:
            node, successors = work[-1]
            for following in successors:
                if index[following] == unseen:
                    enter(following)
                    break
                low[node] = min(low[node], index[following])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    component: list[int] = []
                    while node not in component[-1:]:
                        component.append(stack.pop())
                        index[component[-1]] = finished
                    found.append(component)
    return found


# ----------------------------------------------------------------------
# Blocks put together again: one system of a block and everything it depends on.


def closure_of(solver: BlockSolver, number: int) -> list[int]:
    """The blocks that a block depends on, itself last, in solving order."""
    home = {int(u): k for k, block in enumerate(solver.blocks) for u in block.unknowns}
    wanted, open_ = {number}, [number]
    while open_:
        block = solver.blocks[open_.pop()]
        for known in block.variables[len(block.unknowns) :]:
            before = home.get(int(known))
            if before is not None and before not in wanted:
                wanted.add(before)
                open_.append(before)
    return sorted(wanted)


@dataclass(frozen=True)
class JoinedBlocks:
    """Several blocks as one system over all variables of the whole.

    Variables are the blocks' unknowns in solving order, then the inputs of the whole.

    Parameters
    ----------
    solver : BlockSolver
    members : sequence of int
        Block numbers, closed under dependence.
    """

    solver: BlockSolver
    members: Sequence[int]

    @cached_property
    def blocks(self) -> list[Block]:
        """The member blocks."""
        return [self.solver.blocks[k] for k in self.members]

    @cached_property
    def order(self) -> IndexArray:
        """The variables of the whole in this system's order."""
        own = [block.unknowns for block in self.blocks]
        inputs = np.arange(self.solver.unknowns, self.solver.variables)
        return np.concatenate([*own, inputs]).astype(np.intp)

    @property
    def unknowns(self) -> int:
        """n."""
        return sum(len(block.unknowns) for block in self.blocks)

    @property
    def equation_scale(self) -> Array:
        """(n,)."""
        return np.concatenate([block.system.equation_scale for block in self.blocks])

    @property
    def variable_scale(self) -> Array:
        """(N,)."""
        return self.solver.variable_scale[self.order]

    def _whole(self, v: Array) -> Array:
        """Variables (B, N) of this system's order in that of the whole."""
        whole = np.zeros((len(v), self.solver.variables))
        whole[:, self.order] = v
        return whole

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array]:
        """F, (B, n), and dF/dv, (B, n, N)."""
        whole = self._whole(v)
        order = self.order
        # columns of the whole in this system's order
        place = np.full(self.solver.variables, -1)
        place[order] = np.arange(len(order))
        residual, jacobian = [], np.zeros((len(v), self.unknowns, len(order)))
        row = 0
        for block in self.blocks:
            f, slope = block.system.residual_and_jacobian(whole[:, block.variables])
            residual.append(f)
            rows = np.arange(row, row + f.shape[1])
            jacobian[:, rows[:, None], place[block.variables][None, :]] = slope
            row += f.shape[1]
        return np.concatenate(residual, axis=1), jacobian

    def hessians(self, v: Array, weights: Array) -> Array:
        """Second derivatives of K sums of equations, (K, N, N), with ``weights`` (K, n)."""
        whole, order = self._whole(v[None, :])[0], self.order
        found = np.zeros((len(weights), self.solver.variables, self.solver.variables))
        row = 0
        for block in self.blocks:
            own, n = block.variables, len(block.unknowns)
            found[:, own[:, None], own] += block.system.hessians(
                whole[own], weights[:, row : row + n]
            )
            row += n
        return found[:, order[:, None], order]
