"""Links: every file comes back to the byte, and what is no link is refused with its reason."""

from __future__ import annotations

import hashlib
from pathlib import Path

import pytest

import linkwork as lw
from linkwork.core.foundation.errors import InputError, MechanismFileError
from linkwork.core.textfile.link import LONGEST, fragment_of, is_link, link_of, text_of_link
from linkwork.core.textfile.toml_text import LARGEST
from linkwork.core.textfile.writer import write_text
from tests.campaigns.links import forged, link_campaign, squeezed

APP = "https://example.org/linkwork/"
#: A link that was handed out once is read for ever.
OLD = (
    "#lw1=EX_zsa2Wyw7CIBBF937FxHVFQKhNE7Z-gT9Qn5vWNkH-3xmwRUh9LFzOhBAe5947s91dZiQF9MP5luy2J2_r7R2c"
    "jaFWA5nd1fvAxbVtVLEXbgNEAXln11OXfU6D6Ks_5oKooTGKw8EIyeFoKg4ng__91RzmFB8UvVGsLEBiHYQtlKZGqdk2N4"
    "W_KfedXhPoPeu4QPEn7lTgtUfmsap4hn0KY05jZPiVSE_GNB5KDTjKry092jRQdi6MYv7MqzGYlosH"
)


@pytest.mark.parametrize("name", lw.examples())
def test_a_file_of_the_library_comes_back_exactly_in_at_most_1000_characters(name: str) -> None:
    text = lw.example_text(name)
    saved = write_text(lw.example(name).description)
    for one in (text, saved):
        link = link_of(one, APP)
        assert text_of_link(link) == one
        assert len(link) - len(APP) <= 1000
    assert lw.load(lw.example(name).link()).description == lw.example(name).description


@pytest.mark.parametrize("text", ["", "\r\n", "\ufeffformat = 1\r\n", "θ" * 1000, "a" * LARGEST])
def test_any_text_comes_back_exactly(text: str) -> None:
    assert text_of_link(fragment_of(text)) == text


def test_a_link_of_an_earlier_version_of_linkwork_is_still_read() -> None:
    digest = hashlib.sha256(text_of_link(OLD).encode()).hexdigest()
    assert digest == "a17e33e1409a8a33b2aa305fb650a8362d828572eeea0ccf66796724c16ba738"


def test_the_dictionary_of_version_1_never_changes() -> None:
    words = Path(lw.core.textfile.__file__).with_name("link_words.txt").read_text("utf-8")
    digest = hashlib.sha256(words.encode()).hexdigest()
    assert digest == "0a08d7b1226895bbfc0ae6fe393d6ee3a043b45530e4b7f71db627fac6c6b706", (
        "another dictionary is another version of the link"
    )


@pytest.mark.parametrize(
    "form", ["{}", " {}\n", "https://example.org/{}", "file:///C:/lw.html{}", "x.html?a=1{}"]
)
def test_a_link_is_read_in_every_form(form: str) -> None:
    link = form.format(OLD)
    assert is_link(link)
    assert lw.load(link).name == "Four-bar linkage, open"
    assert lw.load(OLD.removeprefix("#")).name == "Four-bar linkage, open"


GOOD = squeezed(b"format = 1\n")
REFUSED = {
    "four-bar": "has no mechanism: a link of Linkwork ends in #lw1= and the packed mechanism; "
    "nothing is read from the network",
    "https://example.org/four-bar.toml": "has no mechanism: a link of Linkwork ends in #lw1= and "
    "the packed mechanism; nothing is read from the network",
    "#lw2=AAAA": "is of version 2, this version of Linkwork reads version 1: update Linkwork",
    "#lw" + "9" * 10**6 + "=AAAA": "is of version 999999999, this version of Linkwork reads "
    "version 1: update Linkwork",
    "#lw1=" + "A" * 10**7: "has 10,000,005 characters: at most 100,000 are read",
    "#lw1=": "is incomplete or was changed on its way: copy the whole link again",
    "#lw1=A": "is incomplete or was changed on its way: copy the whole link again",
    "#lw1=AAAAAA": "is incomplete or was changed on its way: copy the whole link again",
    OLD[:-1]: "is incomplete or was changed on its way: copy the whole link again",
    OLD[:-1] + "I": "is incomplete or was changed on its way: copy the whole link again",
    OLD + "AAAA": "is incomplete or was changed on its way: copy the whole link again",
    OLD + "=": "has the character '=' at place 261 of its code, which has only letters, digits, "
    "- and _: copy the whole link again",
    "#lw1=AAAA<script>": "has the character '<' at place 5 of its code, which has only letters, "
    "digits, - and _: copy the whole link again",
    "#lw1=AA\0A": "has the character '\\x00' at place 3 of its code, which has only letters, "
    "digits, - and _: copy the whole link again",
    forged(b""): "is damaged: its code is not that of a mechanism file",
    forged(GOOD[:-1]): "is damaged: its code is not that of a mechanism file",
    forged(GOOD + b"12"): "is damaged: its code is not that of a mechanism file",
    forged(b"\xff" * 9): "is damaged: its code is not that of a mechanism file",
    forged(squeezed(b"abc\xff")): "is damaged: its code is not that of a mechanism file",
    forged(squeezed(b"a\0")): "is damaged: its code is not that of a mechanism file",
    forged(squeezed(b"a" * (LARGEST + 1))): "unpacks to more than 1 MB: more is not read",
}


@pytest.mark.parametrize("link", REFUSED, ids=lambda link: str(link)[:30])
def test_a_bad_link_is_refused_with_its_reason(link: str) -> None:
    with pytest.raises(MechanismFileError) as refused:
        text_of_link(link)
    assert str(refused.value) == f"1 problem in the link\n  {REFUSED[link]}"


@pytest.mark.parametrize(
    "text",
    ["<script>alert(1)</script>", "format = 1\nno_such_key = 1", "", "[" * 1000, "format = 2"],
)
def test_a_bad_file_in_a_link_is_refused_as_a_file_is(text: str) -> None:
    with pytest.raises(MechanismFileError) as from_text:
        lw.loads(text, "the link")
    with pytest.raises(MechanismFileError) as from_link:
        lw.load(fragment_of(text))
    assert str(from_link.value) == str(from_text.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a\0", "a link cannot hold this text: it contains a NUL character"),
        ("a\ud800", "a link cannot hold this text: it contains a lone surrogate"),
        (
            "a" * (LARGEST + 1),
            "a link cannot hold 1,000,001 bytes: at most 1,000,000 are read; send the file",
        ),
    ],
)
def test_a_text_that_no_link_can_hold_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError) as refused:
        fragment_of(text)
    assert str(refused.value) == message


def test_a_link_is_never_longer_than_what_is_read() -> None:
    noise = hashlib.shake_256(b"noise").hexdigest(LONGEST)
    with pytest.raises(
        InputError, match=r"^the link would have [\d,]+ characters, at most 100,000"
    ):
        fragment_of(noise)


@pytest.mark.parametrize(
    "app", ["", "example.org", "javascript:alert(1)", "https://", "https://a b", f"{APP}#x", '"', 3]
)
def test_an_app_needs_the_address_of_a_page(app: object) -> None:
    with pytest.raises(
        InputError, match="is not the address of an app: give its whole URL without"
    ):
        lw.example("four-bar").link(app)  # type: ignore[arg-type]


def test_a_changed_mechanism_is_linked_as_it_is_saved(tmp_path: Path) -> None:
    bar = lw.example("four-bar").changed(lengths={"O2 A": 38})
    bar.save(tmp_path / "bar.toml")
    assert text_of_link(bar.link(APP)) == (tmp_path / "bar.toml").read_text("utf-8")


def test_a_file_whose_name_looks_like_a_link_is_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    short = link_of("", None)
    lw.example("jansen-leg").save(short)
    assert is_link(short)
    assert lw.load(short).name == lw.example("jansen-leg").name
    lw.example("jansen-leg").save("#1.toml")
    assert lw.load("#1.toml").name == lw.example("jansen-leg").name


def test_a_path_is_no_link() -> None:
    names = ["four-bar.toml", "#1.toml", "C:\\lw1=\\a.toml", "a/b", "lw=x", "-", ""]
    assert [name for name in names if is_link(name)] == []


def test_damaged_and_forged_links_are_refused_or_right() -> None:
    counts, false = link_campaign(0, 100)
    assert false == []
    assert counts["links refused"] > 50 < counts["calls refused with a message"]
