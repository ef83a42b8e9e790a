"""The rounding of floating-point numbers, and tolerances that several modules share."""

from __future__ import annotations

import numpy as np

#: The distance from 1 to the next larger number, 2⁻⁵²: twice the unit roundoff.
EPSILON = float(np.finfo(float).eps)
#: The same of extended precision, where the processor computes with it.
EXTENDED_EPSILON = float(np.finfo(np.longdouble).eps)
#: The largest relative error of one rounded operation, 2⁻⁵³.
UNIT_ROUNDOFF = EPSILON / 2.0
#: Of an angle: how far it may be off when it is printed in degrees. A link's constant is added, the
#: float of π/180 is rounded, the quotient, and the angle without its whole turns.
PRINTED_ANGLE = 4.0 * UNIT_ROUNDOFF
#: A factor that covers the rounding of a proof's own bounds, which are sums of positive numbers.
PROOF_SLACK = 1.0 + 1e-12

#: Smaller singular values, relative to the largest one of a scaled Jacobian, count as none.
RANK_TOLERANCE = 1e-9
#: Weighted: a correction beyond which Newton-Raphson has run away.
FAR = 1e9
#: Below that rounding, not the equations, decides the ratio of two corrections.
SMALLEST_RATIO = 1e-9
#: The condition number up to which a position has rates, and can begin a curve.
REGULAR_CONDITION = 1e5
#: Weighted: the furthest that a position moves when its input is made exact.
LARGEST_POLISH = 1e-6
#: A position belongs to a tangent of a crossing if its distance from that is at most this part of
#: its distance from the other one.
CLOSER_TANGENT = 0.1
#: Relative to their size: rows of a motion that differ by less show one position, solved twice.
EQUAL_ROWS = 1e-9
#: Relative: slower motion is rest, to the accuracy of positions.
REST = 1e-11
#: A complex solution this near to its mirror image may be a real one.
ALMOST_REAL = 1e-6
#: The same of a multiple solution, whose path ends less precisely.
ALMOST_DOUBLE = 1e-3
