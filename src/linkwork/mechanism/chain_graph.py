"""Comparison of chains by graph isomorphism (networkx)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from linkwork.foundation.errors import MissingPackageError
from linkwork.mechanism.chain import Chain

__all__ = ["contours", "missing", "orbits", "same_graph", "same_inversion"]

Graph = Any  # networkx has no type hints


def _networkx() -> Any:
    """Import on first use: it takes longer to load than the rest of the package."""
    try:
        import networkx
    except ModuleNotFoundError:
        raise MissingPackageError(
            "names of kinematic chains need networkx: pip install networkx"
        ) from None
    return networkx


def missing() -> str:
    """Why chains cannot be compared here; "" if they can."""
    try:
        _networkx()
    except MissingPackageError as error:
        return str(error)
    return ""


def _of_graph6(text: str) -> Graph:
    return _networkx().from_graph6_bytes(text.encode("ascii"))


def _link_graph(chain: Chain) -> Graph:
    """Links as vertices, joints as edges; for chains without multiple joints."""
    graph = _networkx().Graph()
    graph.add_nodes_from(chain.links)
    graph.add_edges_from(joint.links for joint in chain.joints)
    return graph


def _coloured(chain: Chain, ground: str) -> Graph:
    """Links and joints as vertices with their kinds; multiple pins are kept."""
    graph = _networkx().Graph()
    for link in chain.links:
        graph.add_node(("link", link), kind="ground" if link == ground else "link")
    # joints are vertices, since an edge cannot join the three links of a multiple pin
    for k, joint in enumerate(chain.joints):
        graph.add_node(("joint", k), kind=joint.kind.letter)
        graph.add_edges_from((("joint", k), ("link", link)) for link in joint.links)
    return graph


def same_graph(chain: Chain, graph6: str) -> bool:
    """Whether a chain without multiple joints has the graph given in graph6 format.

    References
    ----------
    B. D. McKay, graph6 format, https://users.cecs.anu.edu.au/~bdm/data/formats.txt
    """
    return bool(_networkx().is_isomorphic(_link_graph(chain), _of_graph6(graph6)))


def same_inversion(chain: Chain, ground: str, other: Chain, other_ground: str) -> bool:
    """Whether two chains have the same graph, kinds of joints and fixed link."""

    def same(one: dict[str, str], another: dict[str, str]) -> bool:
        return one["kind"] == another["kind"]

    return bool(
        _networkx().is_isomorphic(
            _coloured(chain, ground), _coloured(other, other_ground), node_match=same
        )
    )


def orbits(chain: Chain) -> list[list[str]]:
    """Equivalence classes of links: fixing any link of a class gives the same inversion."""
    found: list[list[str]] = []
    for link in chain.links:
        alike = (known for known in found if same_inversion(chain, known[0], chain, link))
        known = next(alike, None)
        if known is None:
            found.append([link])
        else:
            known.append(link)
    return found


def contours(incidences: Iterable[tuple[str, str]]) -> list[int]:
    """Numbers of joints of the independent closed contours, from (link, joint) incidences.

    A minimum cycle basis (Horton 1987).
    """
    graph = _networkx().Graph()
    graph.add_edges_from((("link", link), ("joint", joint)) for link, joint in incidences)
    # links and joints alternate around a contour
    return [len(cycle) // 2 for cycle in _networkx().minimum_cycle_basis(graph)]
