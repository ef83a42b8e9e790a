"""Curves of positions, traced one after the other and proved together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.motion.circuit.full_turn import full_turn
from linkwork.motion.curve_branches import TracedCurve, confirmed, trace_boldly, trace_with_proof
from linkwork.motion.drive import Drive
from linkwork.numerics.continuation.change_point import Crossing
from linkwork.numerics.continuation.curve_proof import prove_curve, prove_curves

__all__ = ["Walks"]

_HALVINGS = 12  # of a bold step: one that needs more is traced again with careful ones


class Walks:
    """The curve from each place and heading, traced once.

    Curves are traced boldly at first, and proved together by :meth:`settle`: few large arrays take
    far less time than many small ones. From then on each is proved at once. Where compiled code
    proves a whole turn of the input, nothing remains to be done. ``prove_turns``: whether to prove
    where dead points are.
    """

    def __init__(self, drive: Drive, certify: bool, *, prove_turns: bool = True) -> None:
        self.drive, self.leads, self.certify = drive, drive.leads, certify
        self.prove_turns = prove_turns
        self._known: dict[tuple[bytes, bytes], TracedCurve] = {}
        self._open: dict[tuple[bytes, bytes], tuple[Array, float | Array]] = {}
        self._proved: dict[int, TracedCurve] = {}
        self._turned: dict[int, Array] = {}
        self._settled = not certify

    def walk(
        self, start: Array, heading: float | Array, known: Sequence[Crossing] = ()
    ) -> TracedCurve:
        """The curve from a position (N,) on; its proof may still have to be made.

        ``known``: change points at which it may end, located again if dead points are proved.
        """
        key = start.tobytes(), np.asarray(heading, dtype=float).tobytes()
        forwards = isinstance(heading, float) and heading > 0.0
        if key not in self._known and self.certify and forwards:
            turned = full_turn(self.drive, start)
            if turned is not None:
                self._known[key] = turned
                self._turned[id(turned.curve)] = start
        if key not in self._known:
            ends = None if self.prove_turns else known
            found = trace_boldly(
                self.leads, start, heading, self.certify, prove_turns=self.prove_turns, known=ends
            )
            if self.certify and found.curve.legs:
                if self._settled:
                    proof = prove_curve(self.leads, found.curve)
                    found = confirmed(self.leads, start, heading, found, proof)
                else:
                    self._open[key] = start, heading
            self._known[key] = found
        return self._known[key]

    def settle(self) -> bool:
        """Prove all curves; whether all of them remain. Others were traced again with care."""
        remain = True
        found = [self._known[key] for key in self._open]
        proofs = prove_curves(self.leads, [one.curve for one in found], halvings=_HALVINGS)
        for (key, place), one, proof in zip(self._open.items(), found, proofs, strict=True):
            after = confirmed(self.leads, *place, one, proof)
            self._known[key] = self._proved[id(one.curve)] = after
            remain &= after.curve is one.curve
        self._open.clear()
        self._settled = True
        return remain

    def with_proof(self, walk: TracedCurve) -> TracedCurve:
        """A curve that remained, as it was settled."""
        return self._proved.get(id(walk.curve), walk)

    def stepwise(self, walk: TracedCurve) -> TracedCurve:
        """A curve followed in plain numbers even if compiled code has proved it.

        So the positions that are shown do not depend on what this process has loaded, unless plain
        numbers do not close the curve: then that of compiled code remains, which is proved closed.
        """
        start = self._turned.get(id(walk.curve))
        if start is None:
            return walk
        found = trace_with_proof(self.leads, start, 1.0, self.certify)
        return found if found.curve.end.closed and not found.turns else walk
