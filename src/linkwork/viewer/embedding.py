"""HTML that shows a linked mechanism inside another page."""

from __future__ import annotations

from html import escape

__all__ = ["embed_snippet"]


def embed_snippet(link: str, title: str) -> str:
    """A frame for the source of a course page, as the editors of learning platforms accept it.

    The frame may run the app's scripts and save files; it can neither reach the page around it nor
    cookies, and reads only the link.

    Examples
    --------
    >>> print(embed_snippet("https://example.org/#lw1=A1k-BYOldgA", "Four-bar"))
    <iframe src="https://example.org/#lw1=A1k-BYOldgA" title="Four-bar" width="100%" height="640"
    loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>
    """
    return (
        f'<iframe src="{escape(link)}" title="{escape(title)}" width="100%" height="640"\n'
        'loading="lazy" sandbox="allow-scripts allow-downloads"></iframe>'
    )
