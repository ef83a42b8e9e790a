"""Published forces of a Watt six-bar.

PMKS_Verification @5882a1a, reference-data/v1/cases/watt_i: units m, kg, s, N; input at 10 rpm.
"""

from __future__ import annotations

from collections.abc import Mapping

import pytest

import linkwork as lw

POINTS = {
    "A": (-3.74, -2.41), "B": (-2.72, 0.91), "C": (1.58, 0.43), "D": (-0.24, 4.01),
    "E": (5.08, 5.31), "F": (8.14, 3.35), "G": (7.32, -3.51),
}  # fmt: skip
LINKS = {"AB": "AB", "BCD": "BCD", "DE": "DE", "EF": "EF", "CFG": "CFG"}
MASSES = {
    "AB": (5, 0.1, (-3.23, -0.75)), "BCD": (10, 0.2, (-0.46, 1.7833333333333334)),
    "DE": (5, 0.1, (2.42, 4.66)), "EF": (10, 0.2, (6.61, 4.33)), "CFG": (5, 0.1, (5.68, 0.09)),
}  # fmt: skip
START, LATER = 1.2727207652088244, 1.307627350248711

# on the link named first, as published
WITHOUT = {
    "A AB": (-556.91719204801268, -367.06871193407915),
    "B AB": (554.1208041343707, 357.96674343085232),
    "C BCD": (274.38477891412742, -51.222353507764367),
    "D BCD": (281.00961474946507, 145.521300216165),
    "E DE": (283.14532513340868, -7.5463765365463304),
    "F EF": (-29.412002741522674, -154.75986283544665),
    "G CFG": (91.864246665370786, -303.77417996677821),
}
WITH = {
    "A AB": (-617.28870708788463, -176.5348377830598),
    "B AB": (614.49231917424265, 216.48286927983295),
    "C BCD": (417.90280632453232, -49.763470876510645),
    "D BCD": (197.86310237893218, 100.67854343389192),
    "E DE": (199.99881276287579, -3.3391333188193983),
    "F EF": (-112.55851511205553, -52.452619617719733),
    "G CFG": (152.23576170524279, -150.95805411779756),
}


def watt_six_bar(gravity: lw.Gravity | None) -> lw.Mechanism:
    masses = {}
    for link, (mass, inertia, centre) in MASSES.items():
        first, second = (complex(*POINTS[point]) for point in LINKS[link][:2])
        own = (complex(*centre) - first) / (second - first) * abs(second - first)
        masses[link] = lw.Mass(mass=mass, inertia=inertia, center=(own.real, own.imag))
    mean = tuple(sum(POINTS[p][k] for p in "CFG") / 3.0 for k in (0, 1))
    links = {link: list(points) for link, points in LINKS.items()}
    return lw.linkage(
        name="Watt I",
        length="m",
        angle="rad",
        points={**POINTS, "L": mean},
        links={"ground": ["A", "G"], **links, "CFG": [*"CFG", "L"]},
        inputs=lw.Input(link="AB", speed="10 rpm"),
        masses=masses,
        gravity=gravity,
        loads=[lw.Load(point="L", force=(50, 25))],
    )


@pytest.mark.parametrize(
    ("gravity", "torques", "reactions"),
    [
        (None, (1474.5549914266414, 6219.5020297654346), WITHOUT),
        (lw.Gravity(size="9.81 m/s^2"), (1844.3174729930561, 6371.7624462305657), WITH),
    ],
)
def test_watt_six_bar_has_the_published_torque_and_reactions(
    gravity: lw.Gravity | None,
    torques: tuple[float, float],
    reactions: Mapping[str, tuple[float, float]],
) -> None:
    mechanism = watt_six_bar(gravity)
    found = mechanism.forces(at=START)
    assert found["AB.effort"] == pytest.approx(torques[0], rel=1e-9)
    for name, force in reactions.items():
        point, link = name.split()
        later = max((own for own in LINKS if point in LINKS[own]), key=list(LINKS).index)
        sign = 1.0 if link == later else -1.0
        ours = [sign * found[f"{point}.force.{axis}"] for axis in "xy"]
        assert ours == pytest.approx(force, rel=1e-9), name
    later_on = mechanism.forces(at=LATER)
    assert later_on["AB.effort"] == pytest.approx(torques[1], rel=1e-9)
