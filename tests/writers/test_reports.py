"""Reports: four formats with the same content, whose numbers are those of the results."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import Any

import docx
import numpy as np
import pytest
from click.testing import CliRunner

import linkwork as lw
from linkwork import example_text
from linkwork.core.commands.main import linkwork
from linkwork.core.results.listing import Column
from linkwork.writers.report import report as report_module
from linkwork.writers.report.document import (
    Block,
    Document,
    Equation,
    Facts,
    Figure,
    Section,
    Table,
    Text,
    printed,
    split_columns,
)
from linkwork.writers.report.rendering import document_data, docx_bytes, html_bytes, pdf_bytes
from linkwork.writers.report.report import document_of, report_of, save_report
from linkwork.writers.report.sections import SECTIONS, Findings, Template, template_of
from tests.library_mechanisms import read_example
from tests.writers.coarse import coarse

_DEAD = "rapier-drive-limited"  # a linkage with dead points
_SHORT = 'sections = ["summary", "drawing", "equations", "motion", "proof", "file"]\n'


@cache
def _found(name: str, *sections: str) -> Findings:
    return Findings(coarse(read_example(name), 12), Template(sections=sections))


def _document(name: str, *sections: str) -> Document:
    return document_of(_found(name, *sections))


def _of(mechanism: Any, template: Template) -> Document:
    return document_of(Findings(mechanism, template))


def _section(document: Document, title: str) -> list[Block]:
    return next(list(s.blocks) for s in document.sections if s.title == title)


def _tables(document: Document) -> dict[str, Table]:
    return {b.caption: b for s in document.sections for b in s.blocks if isinstance(b, Table)}


def _facts(document: Document, title: str) -> dict[str, str]:
    pairs = [p for b in _section(document, title) if isinstance(b, Facts) for p in b.pairs]
    return dict(pairs)


def _numbers(column: Column) -> list[float]:
    return [float(cell.replace("\u2212", "-")) for cell in column.cells]


# Formats


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("reports")
    (folder / "short.toml").write_text(_SHORT + 'author = "A. Student"\n')
    mechanism = coarse(read_example("four-bar"), 4)
    files = {}
    for suffix in ("html", "pdf", "docx", "md"):
        files[suffix] = folder / f"bar.{suffix}"
        mechanism.write(files[suffix], template=folder / "short.toml", kind="report")
    return files


class _Page(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.counts: dict[str, int] = {}
        self.links: list[str] = []
        self.identifiers: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.counts[tag] = self.counts.get(tag, 0) + 1
        if tag not in ("meta", "link", "img"):
            self.open.append(tag)
        given = dict(attrs)
        self.links += [v or "" for k, v in attrs if k in ("src", "href", "xlink:href")]
        if given.get("id"):
            self.identifiers.append(given["id"] or "")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in ("meta", "link", "img"):
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_a_page_is_complete_in_itself(written: dict[str, Path]) -> None:
    text = written["html"].read_text("utf-8")
    page = _Page()
    page.feed(text)
    assert not page.open
    assert page.counts["figure"] == 1
    assert page.counts["math"] > 3
    assert all(link.startswith("#") for link in page.links)
    assert len(set(page.identifiers)) == len(page.identifiers)
    assert "A. Student" in text


def test_charts_of_a_page_do_not_share_identifiers() -> None:
    page = _Page()
    page.feed(report_of(_found("four-bar", "plots"), Path("x.html"))[0].decode())
    assert page.counts["figure"] == 3
    assert len(page.identifiers) > 100
    assert len(set(page.identifiers)) == len(page.identifiers)
    assert {link[1:] for link in page.links} <= set(page.identifiers)


def test_a_word_document_has_its_tables_pictures_and_equations(written: dict[str, Path]) -> None:
    file = docx.Document(str(written["docx"]))
    body = file.element.xml
    assert len(file.inline_shapes) == 1
    # every equation ends with its number
    assert re.findall(r"<w:t[^>]*>\s*\((\d)\)</w:t>", body) == ["1", "2", "3"]
    assert body.count("<m:oMath>") + body.count("<m:oMath ") > 6
    heads = [[cell.text for cell in table.rows[0].cells] for table in file.tables]
    assert ["crank [deg]", "coupler [deg]", "rocker [deg]", "μ [deg]"] in heads
    assert file.core_properties.author == "A. Student"


def test_markdown_names_pictures_that_exist(written: dict[str, Path]) -> None:
    text = written["md"].read_text("utf-8")
    pictures = re.findall(r"!\[.*\]\((.*)\)", text)
    assert pictures == ["bar-pictures/figure-1.png"]
    assert all((written["md"].parent / name).read_bytes()[:4] == b"\x89PNG" for name in pictures)
    assert text.count("$$") == 6


def test_tables_that_fit_stay_on_one_page() -> None:
    document = _document("four-bar", "motion")
    lone, *_ = _tables(document).values()
    twice = (replace(c, cells=(*c.cells, *c.cells)) for c in lone.columns)
    long = replace(lone, columns=tuple(twice))
    assert [lone.is_short, long.is_short] == [True, False]
    section = Section(title="T", blocks=(lone, long))
    document = Document.numbered("T", (), [section])
    html = html_bytes(document, lambda part: None).decode()
    assert re.findall(r'<div class="(scroll[^"]*)"', html) == ["scroll short", "scroll"]
    (data,) = document_data(document, {})["sections"]
    assert [block["short"] for block in data["blocks"]] == [True, False]
    body = docx.Document(BytesIO(docx_bytes(document, lambda part: None))).tables
    kept = [[bool(row.cells[0].paragraphs[0].paragraph_format.keep_with_next) for row in t.rows]
            for t in body]  # fmt: skip
    assert kept == [[True] * 13 + [False], [False] * 27]


def test_two_runs_write_the_same_bytes(written: dict[str, Path]) -> None:
    folder, mechanism = written["md"].parent, coarse(read_example("four-bar"), 4)
    files = mechanism.write(folder / "again.md", template=folder / "short.toml", kind="report")
    assert files == (folder / "again.md", folder / "again-pictures/figure-1.png")
    again = files[0].read_bytes().replace(b"again-pictures", b"bar-pictures")
    assert again == written["md"].read_bytes()
    # the document of a further run, in the other formats
    document = _of(coarse(read_example("four-bar"), 4), template_of(str(folder / "short.toml")))
    for suffix, to_bytes in (("html", html_bytes), ("pdf", pdf_bytes), ("docx", docx_bytes)):
        assert to_bytes(document, lambda part: None) == written[suffix].read_bytes(), suffix
    assert written["pdf"].read_bytes().startswith(b"%PDF")


# Contents


def test_the_table_of_the_motion_has_the_values_and_rates_of_the_motion() -> None:
    motion = _found("four-bar", "motion").motion
    assert motion is not None
    tables = _tables(_document("four-bar", "motion"))
    for caption, suffix in (("Motion", ""), ("Velocities", ".velocity")):
        crank, coupler, *_ = tables[caption].columns
        assert _numbers(crank) == motion.inputs["crank"].tolist()
        # three decimals of angles; rates have at least four
        np.testing.assert_allclose(_numbers(coupler), motion[f"coupler{suffix}"], atol=5.001e-4)
    assert [c.header for c in tables["Accelerations"].columns] == [
        "crank [deg]", "coupler [rad/s²]", "rocker [rad/s²]", "μ [rad/s²]",
    ]  # fmt: skip


def test_rows_at_the_distance_asked_for() -> None:
    template = Template(sections=("motion",), every=60, quantities=("rocker",))
    tables = _tables(_of(coarse(read_example("four-bar"), 12), template))
    crank, rocker = tables["Motion"].columns
    assert _numbers(crank) == [0, 60, 120, 180, 240, 300, 360]
    assert rocker.header == "rocker [deg]"


def test_a_motion_of_one_row_has_a_table_of_one_row() -> None:
    bar = read_example("four-bar").changed(inputs=[lw.Input(link="crank", from_=60, to=60)])
    crank, *_ = _tables(_of(bar, Template(sections=("motion",))))["Motion"].columns
    assert _numbers(crank) == [60]


def test_missing_and_infinite_values_have_no_range() -> None:
    lost = {"none": "sqrt(-1 - cos(crank)^2)", "poles": "1/sin(crank)"}
    template = Template(sections=("motion", "plots"), quantities=("rocker", *lost))
    document = _of(coarse(read_example("four-bar"), 12).changed(outputs=lost), template)
    _, low, *_ = _tables(document)["Ranges over all rows of the motion"].columns
    assert low.cells[1] == "-"
    assert float(low.cells[0]) > 0


def test_a_crank_alone_has_no_table_and_no_plots() -> None:
    crank = lw.linkage(
        points={"O": (0, 0), "A": (40, 0)},
        links={"ground": ["O"], "crank": ["O", "A"]},
        inputs=[lw.Input(link="crank", step=30)],
    )
    document = _of(crank, Template(sections=("motion", "plots", "tolerances")))
    assert _tables(document) == {}
    assert _facts(document, "Motion")["found"] == "13"
    reasons = _facts(document, "Sections left out")
    assert reasons["Plots"] == "the mechanism has no unknown, output or traced point"
    assert reasons["Tolerances"] == "the mechanism has no unknown and no output"


def test_limits_and_missing_positions_are_noted_in_the_table() -> None:
    motion = _found(_DEAD, "motion").motion
    assert motion is not None
    limits = [limit for limit in motion.limit if limit]
    tables = _tables(_document(_DEAD, "motion"))
    note = tables["Motion (continued)"].columns[-1]
    assert note.header == "note"
    assert [cell for cell in note.cells if cell in limits] == limits
    assert note.cells.count("out of reach") == motion.counts[lw.Status.OUT_OF_REACH]


def test_dimensions_are_those_of_the_file() -> None:
    found = _found("rapier-drive", "dimensions")
    names, values = _tables(_document("rapier-drive", "dimensions"))["Dimensions"].columns
    given = dict(found.model.description.dimensions)
    assert names.cells == list(given)
    assert _numbers(values) == list(given.values())
    assert values.header == "value [mm]"


def test_iterations_are_those_of_the_position() -> None:
    (trail,) = _found("rapier-drive", "newton").position.steps
    tables = _tables(_document("rapier-drive", "newton"))
    iterates = next(iter(tables.values()))
    assert _numbers(iterates.columns[0]) == [step.k for step in trail.steps]
    angles = [step.unknowns["θ13"] for step in trail.steps]
    # six decimals, as in the columns of solve --steps
    np.testing.assert_allclose(_numbers(iterates.columns[1]), angles, atol=5.001e-7)
    systems = [caption for caption in tables if caption.startswith("F and J")]
    assert len(systems) == len(trail.steps) - 1


def test_vectors_close_the_loop() -> None:
    tables = _tables(_document("rapier-drive", "vectors"))
    assert len(tables) == 2
    for table in tables.values():
        sides, xs = table.columns[1].cells, _numbers(table.columns[4])
        total = sum(x if side == "left" else -x for side, x in zip(sides, xs, strict=True))
        # two decimals of each vector are printed
        assert abs(total) <= 0.005 * len(xs)


def test_forces_are_those_of_the_results() -> None:
    found = _found("crank-press", "forces")
    table = _tables(_document("crank-press", "forces"))["Smallest and largest forces"]
    names, low, _, high, _, units = table.columns
    row = list(names.cells).index("crank.effort")
    effort = found.forces.values["crank.effort"]
    # six digits are printed
    assert float(low.cells[row]) == pytest.approx(effort.min(), rel=1e-5)
    assert float(high.cells[row]) == pytest.approx(effort.max(), rel=1e-5)
    assert units.cells[row] == found.forces.units["crank.effort"]


def test_lists_are_those_of_the_results() -> None:
    sections = ("circuits", "configurations")
    found, document = _found(_DEAD, *sections), _document(_DEAD, *sections)
    tables = _tables(document)
    assert [caption for caption in tables if caption.startswith("Branches")] == [
        f"Branches of {circuit.name}" for circuit in found.circuits
    ]
    listed = next(t for caption, t in tables.items() if caption.startswith("Configurations"))
    assert listed.columns[0].cells == found.configurations.names
    facts = [b for b in _section(document, "Circuits and dead points") if isinstance(b, Facts)]
    dead = [p for fact in facts for p in fact.pairs if p[0] == "dead point"]
    assert len(dead) == sum(len(circuit.dead_points) for circuit in found.circuits) > 0


def test_the_paragraph_on_proofs_counts_the_rows() -> None:
    text = _proof("rapier-drive")
    assert text.startswith(
        "Rows with a position: 13 of 13. Rows with a complete proof: 13. In each"
    )
    assert "Not proved are rates and plots" in text


def test_rows_without_a_proof_are_counted_with_their_reason() -> None:
    assert "complete proof: 0. Rows without it: 13; proved for the mech" in _proof("dixon-one")
    assert "true position within" in _proof("newton-convergence")
    assert "of the size of the guess" in _proof("newton-convergence")
    assert _proof("newton-extremum").startswith("No position was found")


def _proof(name: str) -> str:
    paragraph = _section(_document(name, "proof"), "What is proved")[0]
    assert isinstance(paragraph, Text)
    return paragraph.text


def test_tolerances_are_those_of_the_results() -> None:
    mechanism = coarse(read_example("slider-crank"), 4).changed(tolerances={"B A": 0.05})
    template = Template(sections=("tolerances",), tolerances_of=("d",))
    found = Findings(mechanism, template, 60)
    (contribution,) = _tables(document_of(found)).values()
    share = lw.design.tolerance(mechanism, "d", at=60).contributions[0]
    assert contribution.columns[0].cells == [share.name]
    sensitivity = contribution.columns[2].cells[0].partition(" ")[0]
    assert float(sensitivity) == pytest.approx(share.sensitivity, rel=1e-5)  # six digits


def test_an_unknown_quantity_of_the_template_is_refused() -> None:
    bar = coarse(read_example("four-bar"), 4).changed(tolerances={"A B": 0.05})
    for template in (
        Template(sections=("motion",), quantities=("rokcer",)),
        Template(sections=("tolerances",), tolerances_of=("rokcer",)),
    ):
        with pytest.raises(lw.UnknownNameError, match=r'no "rokcer" \(nearest: rocker'):
            _of(bar, template)


@pytest.mark.parametrize(
    "wrong",
    ['quantities = ["rokcer"]', 'tolerances_of = ["rokcer"]', "every = 37"],
)
def test_a_template_that_does_not_fit_is_refused_before_any_computation(
    wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "t.toml").write_text(f'sections = ["motion", "tolerances"]\n{wrong}\n')
    bar = coarse(read_example("four-bar"), 4).changed(tolerances={"A B": 0.05})
    monkeypatch.setattr(report_module, "document_of", lambda *_: pytest.fail("it computes"))
    with pytest.raises(
        lw.InputError,
        match=r'no "rokcer"|every = 37: the motion has no two rows .* take a multiple of its step',
    ):
        bar.write(tmp_path / "bar.html", template=tmp_path / "t.toml", kind="report")


def test_purpose_and_source_are_shown_as_they_are_written() -> None:
    source = "doi 10.1115/1.2345678901, p. 3 -5: x^2"
    bar = coarse(read_example("four-bar"), 2).changed(source=source)
    assert _facts(_of(bar, Template(sections=("summary",))), "Summary")["source"] == source


def test_the_file_is_shown_as_it_is_written() -> None:
    text = "# mine\n" + example_text("four-bar")
    template = Template(sections=("file",))
    found = Findings(lw.loads(text), template)
    assert _section(document_of(found), "Mechanism file")[-1] == Text(text=text, style="listing")


def test_sections_without_content_are_named_with_the_reason() -> None:
    reasons = _facts(_document("four-bar", "paths", "forces", "tolerances"), "Sections left out")
    assert reasons["Paths of points"] == "the file traces no point"
    assert reasons["Forces"].startswith("nothing loads Four-bar linkage, open")
    assert reasons["Tolerances"].startswith("nothing deviates")


def test_a_mechanism_without_input_has_its_position() -> None:
    truss = lw.linkage(
        points={"A": (0, 0), "B": (40, 0), "C": (20, 30)},
        links={"ground": ["A", "B"], "left": ["A", "C"], "right": ["B", "C"]},
    )
    template = Template(sections=("motion", "plots", "proof"))
    document = document_of(Findings(truss, template))
    names, values = _tables(document)["Points"].columns
    assert float(values.cells[list(names.cells).index("C.x")]) == 20
    assert _facts(document, "Sections left out")["Plots"] == "the mechanism has no input"
    assert isinstance(proof := _section(document, "What is proved")[0], Text)
    assert "true position within" in proof.text


def test_a_mechanism_that_does_not_close_says_why() -> None:
    bar = coarse(read_example("four-bar"), 2).with_dimensions({"A B": 30, "O4 B": 20})
    template = Template(sections=("summary", "drawing", "plots"))
    found = Findings(bar, template)
    document = document_of(found)
    assert found.position.failure is not None
    assert _facts(document, "Summary")["why"] == found.position.failure.what
    assert _facts(document, "Sections left out")["Drawing"] == "no position was found"


def test_equations_tables_and_figures_are_numbered() -> None:
    document = _document("rapier-drive", "drawing", "vectors", "equations", "dimensions")
    blocks = [b for section in document.sections for b in section.blocks]
    for kind, count in ((Equation, 6), (Table, 4), (Figure, 2)):
        assert [b.number for b in blocks if isinstance(b, kind)] == list(range(1, count + 1))


# Tables


def test_wide_tables_are_split_and_repeat_their_first_column() -> None:
    columns = [Column(header=f"column {k}", cells=["1" * 16]) for k in range(9)]
    parts = list(split_columns(columns))
    # three of 19 characters after the first, instead of four and one
    assert [len(part) for part in parts] == [4, 4, 3]
    assert {part[0].header for part in parts} == {"column 0"}
    assert [c.header for part in parts for c in part[1:]] == [f"column {k}" for k in range(1, 9)]


def test_numbers_have_powers_of_ten_and_their_points_below_each_other() -> None:
    column = Column(header="x", cells=["-1.5e-07", "12", "-", "here"], align="point")
    assert [cell.rstrip("\u2007\u2008") for cell in printed(column)] == [
        "\u22121.5·10⁻⁷", "12", "–", "here",
    ]  # fmt: skip
    plain = printed(Column(header="x", cells=["1.25", "12"], align="point"))
    assert plain == ["1.25", "12\u2008\u2007\u2007"]


def test_numbers_in_sentences_have_seven_digits_and_powers_of_ten() -> None:
    text = "x^2 and x^20 at -150.123456789 deg, 12345678.5 mm, 1.5e-07, rows 3-5"
    section = Section(title="", blocks=(Text(text=text),))
    (shown,) = Document.numbered("", (), [section]).sections[0].blocks
    assert shown == Text(text="x² and x^20 at −150.1235 deg, 1.234568·10⁷ mm, 1.5·10⁻⁷, rows 3-5")


# Templates


@pytest.mark.parametrize("name", ["engineer", "student"])
def test_the_templates_of_the_package_have_known_sections(name: str) -> None:
    assert set(template_of(name).sections) <= set(SECTIONS)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('sections = ["motions"]', 'line 1  sections[1]  must be "summary" or'),
        ('sections = ["motion", "motion"]', 'has "motion" twice: name each section once'),
        ('sections = ["motion"]\nevery = 0', "line 2  every  must be a positive step"),
        ('sections = ["motion"]\nauthor = 3', "line 2  author"),
        ('sections = ["motion"]\nauthors = "A"', "line 2  authors"),
        ('title = "A"', "sections"),
    ],
)
def test_wrong_templates_are_refused_with_the_line(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(text)
    with pytest.raises(lw.MechanismFileError) as caught:
        template_of(tmp_path / "own.toml")
    assert message in re.sub(r" {2,}", "  ", str(caught.value))


def test_unknown_templates_formats_and_packages_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bar = coarse(read_example("four-bar"), 2)
    with pytest.raises(lw.InputError, match=r'no template "enginer" \(templates: engineer'):
        bar.write(tmp_path / "x.html", template="enginer", kind="report")
    with pytest.raises(lw.InputError, match=r"a report is one of \.html, \.pdf, \.docx, \.md"):
        bar.write(tmp_path / "x.odt", kind="report")
    (tmp_path / "short.toml").write_text('sections = ["versions"]')
    monkeypatch.setattr(report_module, "document_of", lambda *_: pytest.fail("it computes"))
    for suffix, package in (("pdf", "typst"), ("docx", "docx")):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(lw.MissingPackageError, match=r'pip install "linkwork\[report\]"'):
            bar.write(tmp_path / f"x.{suffix}", template=tmp_path / "short.toml", kind="report")
        assert not (tmp_path / f"x.{suffix}").exists()


def test_places_that_cannot_be_written_are_refused(tmp_path: Path) -> None:
    pictures = {"bar-pictures/figure-1.png": b"png"}
    (tmp_path / "bar-pictures").write_text("a file, no folder")
    for name, shown in (("bar.md", "bar-pictures"), ("no/bar.md", "no/bar-pictures")):
        with pytest.raises(lw.InputError, match=rf'cannot write ".*/{shown}"'):
            save_report(tmp_path / name, b"#", pictures)
        assert not (tmp_path / name).exists()
    assert not (tmp_path / "no").exists()


def test_pictures_are_not_written_without_their_file(tmp_path: Path) -> None:
    (tmp_path / "bar.md").mkdir()
    pictures = {"bar-pictures/figure-1.png": b"png"}
    with pytest.raises(lw.InputError, match=r'cannot write ".*/bar\.md": Is a directory'):
        save_report(tmp_path / "bar.md", b"#", pictures)
    assert [path.name for path in tmp_path.iterdir()] == ["bar.md"]


def test_the_command_writes_a_report(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text('sections = ["proof"]')
    args = [
        "export",
        "report",
        "four-bar",
        "-o",
        str(tmp_path / "bar.html"),
        "--author",
        "B. Engineer",
    ]
    done = CliRunner().invoke(linkwork, [*args, "--template", str(tmp_path / "short.toml")])
    assert done.output == f"Wrote {tmp_path / 'bar.html'}.\n"
    assert "B. Engineer" in (tmp_path / "bar.html").read_text("utf-8")


@pytest.mark.extended
@pytest.mark.parametrize("name", sorted(lw.examples()))
def test_every_mechanism_of_the_library_has_a_report(name: str, tmp_path: Path) -> None:
    # drawings and lists of all mechanisms are tested elsewhere
    sections = '"summary", "vectors", "dimensions", "equations", "newton", "motion", "proof"'
    (tmp_path / "own.toml").write_text(f"sections = [{sections}]")
    mechanism = coarse(read_example(name), 6)
    for suffix in ("html", "md"):
        mechanism.write(tmp_path / f"x.{suffix}", template=tmp_path / "own.toml", kind="report")
    page = _Page()
    page.feed((tmp_path / "x.html").read_text("utf-8"))
    assert not page.open
    text = (tmp_path / "x.md").read_text("utf-8")
    assert "nan" not in re.split(r"\W+", text)
    assert "What is proved" in text


def test_reports_leave_out_what_a_question_hides(tmp_path: Path) -> None:
    ask = lw.Question(text="How far?", answer=52.75, tolerance=1, unit="deg")
    bar = coarse(lw.example("four-bar"), 36).changed(questions=[ask])
    (file,) = bar.write(tmp_path / "bar.html", kind="report")
    text = file.read_text("utf-8")
    left_out = text.count("a question of the file hides it")
    kept = re.findall(r"<h2[^>]*>(.*?)</h2>", text)
    assert left_out >= 6
    assert not any("Motion" in head or "Plots" in head or "Circuits" in head for head in kept)
    assert "Mechanism file" not in kept
    assert "52.75" not in text
    assert "The mechanism crank" not in text
    bar.changed(questions=()).write(tmp_path / "bar.html", kind="report")
    assert "a question of the file" not in file.read_text("utf-8")
