"""The page simulates: the motion in time, its events and table, and forms that mend a refusal."""

from __future__ import annotations

import base64
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import linkwork as lw
from linkwork.app.live import events as tell, requests as ask
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.session import BrowserDesk
from linkwork.app.live.workbench import Workbench
from linkwork.app.pages.packing import play_order
from linkwork.synthesis.solvers.solving import solve_task
from tests.app.live.conftest import Served, ask as send, serving, told
from tests.app.live.test_live_page import open_live as open_live

Open = Callable[..., Any]

PENDULUM = """\
format = 1
name = "Pendulum"
length = "m"

[points]
O = [0, 0]
A = [-1, 0]

[links]
ground = ["O"]
bar = ["O", "A"]  # swings

[gravity]

[masses]
bar = { mass = 1, center = [1, 0] }

[[stops]]
of = "bar"
to = 300
restitution = 0.5

[input]
link = "bar"
"""


@pytest.fixture
def swing(tmp_path: Path) -> Workbench:
    """A workbench on a pendulum that hits a stop."""
    path = tmp_path / "pendulum.toml"
    path.write_text(PENDULUM, encoding="utf-8")
    return Workbench(MechanismFile(path), lw.loads)


def simulated(bench: Workbench, **fields: Any) -> tell.SimulationFound:
    (found,) = bench.handle(ask.Simulate(**fields))
    assert isinstance(found, tell.SimulationFound), found
    return found


def csv_of(bench: Workbench) -> list[str]:
    (file,) = bench.handle(ask.Export(format="csv", simulated=True))
    assert isinstance(file, tell.Exported), file
    assert file.name.endswith("-simulation.csv")
    return base64.b64decode(file.content).decode().splitlines()


def test_a_simulation_has_the_rows_events_and_table_of_the_library(swing: Workbench) -> None:
    found = simulated(swing, until="1500 ms", start_speed="10 deg/s", at={"bar": "190 deg"})
    own = lw.loads(PENDULUM).simulate(1.5, start_speed="10 deg/s", at={"bar": 190})
    assert (found.rows, found.complete) == (len(own), True)
    assert [(e.row, e.t) for e in found.events] == [
        (row, own["t"][row]) for row, word in enumerate(own.limit) if word
    ]
    assert {e.text for e in found.events} == {"stop of bar"}
    head, *rows = csv_of(swing)
    table = own.table()
    assert head.split(",")[0].startswith("t")
    assert [float(row.split(",")[0]) for row in rows] == list(table.columns["t"])
    assert found.page is not None
    assert len(found.page.motions[0].limits) == len(found.events)


def test_several_inputs_have_start_speeds_by_name(tmp_path: Path) -> None:
    path = tmp_path / "double.toml"
    path.write_text(lw.example_text("double-pendulum"), encoding="utf-8")
    bench = Workbench(MechanismFile(path), lw.loads)
    found = simulated(bench, until=0.2, start_speeds={"upper": "20 deg/s", "lower": ""})
    own = lw.example("double-pendulum").simulate(0.2, start_speed={"upper": "20 deg/s"})
    assert (found.rows, found.complete) == (len(own), True)
    head, *rows = csv_of(bench)
    column = [name.partition(" ")[0] for name in head.split(",")].index("upper")
    assert [float(row.split(",")[column]) for row in rows] == pytest.approx(own["upper"], rel=1e-12)


def test_rows_are_close_enough_for_a_long_motion_to_look_smooth(swing: Workbench) -> None:
    assert simulated(swing, until=18.0).rows > 18.0 / 0.041
    (refused,) = swing.handle(ask.Simulate(until=10.0, step=1e-4))
    assert isinstance(refused, tell.SimulationFound)
    assert "more than 3000 rows" in refused.message


def test_rest_keeps_its_rows_and_the_order_of_time() -> None:
    resting = lw.loads(PENDULUM.replace("to = 300\nrestitution = 0.5", "to = 260"))
    motion = resting.simulate(2, certify=False)
    order, closed = play_order(motion)
    assert not closed
    assert order.tolist() == list(range(len(motion)))
    assert np.ptp(motion["bar"][order[-20:]]) == 0.0


@pytest.mark.parametrize(
    ("change", "request_", "says", "forms"),
    [
        (("bar = { mass = 1, center = [1, 0] }", ""), {}, "has mass", ["masses", "motor"]),
        (("[input]", '[input]\nlaw = "180+90*t"\nto = 1'), {}, "A law drives", ["text"]),
        (('of = "bar"', 'of = "bra"'), {}, 'no "bra"', []),
        (("to = 300", "to = 100"), {}, "beyond its stop", ["stops", "start"]),
        (("", ""), {"until": "soon"}, 'got "soon"', ["start"]),
        (("", ""), {"until": -1.0}, "positive time", ["start"]),
        (("", ""), {"start_speed": "5 m"}, "Start speed", ["start"]),
        (("", ""), {"at": {"bra": 1.0}}, "bra", ["start"]),
    ],
)
def test_a_refusal_names_the_forms_that_mend_it(
    tmp_path: Path, change: tuple[str, str], request_: dict[str, Any], says: str, forms: list[str]
) -> None:
    path = tmp_path / "pendulum.toml"
    path.write_text(PENDULUM.replace(*change), encoding="utf-8")
    bench = Workbench(MechanismFile(path), lw.loads)
    found = simulated(bench, **{"until": 1.0, **request_})
    assert says in found.message
    assert [each.form for each in found.forms] == forms
    assert (found.page, found.complete) == (None, False)


def test_quantities_of_the_simulation_are_plotted(swing: Workbench) -> None:
    assert swing.handle(ask.ShowQuantities(names=("bar.d1",), simulated=True)) == []
    simulated(swing, until=0.2)
    (found,) = swing.handle(ask.ShowQuantities(names=("bar.acceleration",), simulated=True))
    assert isinstance(found, tell.SimulationFound)
    assert found.page is not None
    assert "bar.acceleration" in {column.name for column in found.page.motions[0].columns}
    (listed,) = swing.handle(ask.ListQuantities(simulated=True))
    assert isinstance(listed, tell.QuantitiesListed)
    assert {"kinetic_energy", "O.force.x"} <= {each.name for each in listed.quantities}


def test_a_change_ends_the_simulation(swing: Workbench) -> None:
    simulated(swing, until=0.1)
    swing.handle(ask.SetMass(link="bar", mass=2.0, x=1.0, y=0.0))
    (refused,) = swing.handle(ask.Export(format="csv", simulated=True))
    assert isinstance(refused, tell.Refused)


def test_a_long_simulation_reports_progress_and_is_cancelled_through_the_socket(
    swing: Workbench,
) -> None:
    with serving(swing) as server, Served(server, swing, Path()).connect() as page:
        send(page, "simulate", id=7, until=5000.0, start_speed="900 deg/s")
        assert 0.0 < told(page, "working")["fraction"] < 1.0
        send(page, "cancel", id=8)
        refused = told(page, "refused")
        assert refused["answers"] == 7
        assert "cancelled" in refused["message"]


def test_a_worker_cancels_between_two_steps() -> None:
    events: list[str] = []
    waiting = ['{"kind": "simulate", "id": 1, "until": 5000, "start_speed": "900 deg/s"}']
    began = time.monotonic()

    def take() -> list[str]:
        now = waiting[:]
        waiting.clear()
        return now

    def pause() -> None:
        if time.monotonic() - began > 0.1:
            waiting.append('{"kind": "cancel", "id": 2}')

    desk = BrowserDesk(lw.loads, lw.example_text, events.append, take, solve_task, pause)
    desk.open("pendulum.toml", PENDULUM)
    assert desk.work()
    assert "cancelled" in events[-1]
    assert '"answers":1' in events[-1]


def _simulated(server: Any, watched: Callable[..., Any]) -> Any:
    """A page that shows a simulation."""
    page = watched((f"http://127.0.0.1:{server.port}/",), reduced_motion="no-preference")
    page.goto(server.address)
    page.wait_for_selector(".lw[data-row]")
    page.get_by_role("tab", name="Simulate").click()
    page.get_by_label("Until").fill("1.5")
    page.get_by_label("Start speed").fill("10 deg/s")
    page.get_by_label("Until").press("Enter")
    page.wait_for_selector('.lw-simulate [data-complete="true"]')
    return page


def test_events_of_a_simulation_lead_to_their_rows(
    serve: Callable[[Workbench], Any], watched: Callable[..., Any], swing: Workbench
) -> None:
    page = _simulated(serve(swing), watched)
    own = lw.loads(PENDULUM).simulate(1.5, start_speed="10 deg/s")
    hits = [row for row, word in enumerate(own.limit) if word]
    assert page.locator(".lw-marks span").count() == len(hits)
    page.locator(".lw-events button").first.click()
    assert "stop of bar" in page.locator(".lw-readout").inner_text()
    assert int(page.locator(".lw").get_attribute("data-row")) == hits[0]


@pytest.mark.extended
def test_a_simulation_plays_in_its_own_time(
    serve: Callable[[Workbench], Any], watched: Callable[..., Any], swing: Workbench
) -> None:
    page = _simulated(serve(swing), watched)
    own = lw.loads(PENDULUM).simulate(1.5, start_speed="10 deg/s")
    hits = [row for row, word in enumerate(own.limit) if word]

    def clock() -> float:
        return float(page.locator(".lw-readout").inner_text().split()[2])

    page.locator(".lw-speed").select_option("0.1")
    began, passed = clock(), time.monotonic()
    page.wait_for_timeout(300)
    # a slow page leaves time out, but none plays faster
    assert 0.0 < clock() - began < 0.1 * (time.monotonic() - passed) + 0.02
    page.locator(".lw-events button").first.click()
    chart = page.locator(".lw-chart").last
    assert chart.get_by_label("Quantity to plot").input_value() == "bar"
    assert chart.get_by_label("Rate").input_value() == "velocity"
    said = chart.locator(".lw-value").inner_text().replace("\u2212", "-")
    assert float(said.split()[0]) == pytest.approx(own["bar.velocity"][hits[0]], rel=1e-5)
    page.get_by_role("button", name="Back to the motion of the file").click()
    assert "bar = " in page.locator(".lw-readout").inner_text()
