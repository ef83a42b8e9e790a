"""Norton, Design of Machinery, chapter 4, and printed results on the same mechanisms."""

from __future__ import annotations

import pytest

import linkwork as lw


def test_norton_4_1_open_and_crossed_at_30_degrees() -> None:
    open_ = lw.example("four-bar").solve(at=30)
    assert open_["coupler"] == pytest.approx(22.40901460149503, abs=1e-12)
    assert open_["rocker"] == pytest.approx(55.26777722321222, abs=1e-12)
    crossed = lw.example("four-bar-crossed").solve(at=30)
    assert crossed["coupler"] == pytest.approx(-56.43747800088165, abs=1e-12)
    assert crossed["rocker"] == pytest.approx(-89.29624062259883, abs=1e-12)


def test_norton_4_1_angular_velocities_at_25_rad_per_second() -> None:
    position = lw.example("four-bar").solve(at=30)
    assert position.velocity["coupler"] == pytest.approx(-6.55597952, abs=5e-9)
    assert position.velocity["rocker"] == pytest.approx(3.04339609, abs=5e-9)


def test_norton_4_1_angular_accelerations_with_an_input_acceleration_of_15() -> None:
    position = lw.example("four-bar").solve(at=30)
    for link, printed in (("coupler", 398.4663), ("rocker", 677.2269)):
        acceleration = position.acceleration[link] + 15 * position.first[link]
        assert acceleration == pytest.approx(printed, abs=5e-5)


@pytest.mark.parametrize(
    ("offset", "guess", "rod", "slider", "digits"),
    [
        # c = +20 is printed with fewer digits than c = -20
        (20, {"θ3": 170, "d": 140}, 172.99, 139.1, (5e-3, 5e-2)),
        (20, {"θ3": 10, "d": -100}, 7.01, -99.103, (5e-3, 5e-4)),
        (-20, {"θ3": 155, "d": 130}, 152.913072, 126.838005, (5e-7, 5e-7)),
        (-20, {"θ3": 25, "d": -90}, 27.086928, -86.838005, (5e-7, 5e-7)),
    ],
)
def test_norton_4_2_slider_crank_both_assemblies(
    offset: float,
    guess: dict[str, float],
    rod: float,
    slider: float,
    digits: tuple[float, float],
) -> None:
    mechanism = lw.example("crank-slider").with_dimensions(c=offset)
    position = mechanism.changed(guess={"θ2": 60, **guess}).solve()
    assert position["θ3"] == pytest.approx(rod, abs=digits[0])
    assert position["d"] == pytest.approx(slider, abs=digits[1])


def test_norton_4_2_rates_at_minus_30_rad_per_second() -> None:
    position = lw.example("crank-slider").with_dimensions(c=20).solve(at=60)
    assert position.velocity["θ3"] == pytest.approx(5.038, abs=5e-4)
    assert position.velocity["d"] == pytest.approx(1113, abs=0.5)


def test_norton_4_3_slider_as_input_both_assemblies() -> None:
    mechanism = lw.example("slider-input")
    position = mechanism.solve(at=100)
    assert position["θ2"] == pytest.approx(95.798, abs=5e-4)
    assert position["θ3"] == pytest.approx(150.113, abs=5e-4)
    other = mechanism.changed(guess={"d": 100, "θ2": -118, "θ3": 187}).solve()
    assert other["θ2"] == pytest.approx(-118.418, abs=5e-4)
    assert other["θ3"] == pytest.approx(187.267, abs=5e-4)


def test_slider_crank_as_points_and_links_gives_norton_s_numbers() -> None:
    position = lw.example("slider-crank").solve(at=60)
    assert position["rod"] == pytest.approx(152.913072, abs=5e-7)
    assert position["d"] == pytest.approx(126.838005, abs=5e-7)


def test_solvespace_coupler_point_of_a_four_bar() -> None:
    mechanism = lw.linkage(
        points={"A0": (0, 0), "A": (25, 25), "B": (90, 40), "B0": (90, 0), "P": (40, 62)},
        links={
            "ground": ["A0", "B0"],
            "crank": ["A0", "A"],
            "coupler": ["A", "B", "P"],
            "rocker": ["B0", "B"],
        },
        lengths={"A0 A": 35, "A B": 70, "B0 B": 70, "A P": 40, "B P": 40},
        inputs=lw.Input(link="crank"),
    )
    x, y = mechanism.solve(at=45).points["P"]
    assert (x, y) == pytest.approx((39.54852759, 61.91009104), abs=5e-9)
