"""All solvers that are compared, in the order of the tables."""

from __future__ import annotations

from benchmarks.peers.casadi_newton import CasadiNewton
from benchmarks.peers.exudyn_statics import ExudynStatics
from benchmarks.peers.kinepy_groups import KinepyGroups
from benchmarks.peers.linkwork_family import LinkworkFamily
from benchmarks.peers.linkwork_sweep import LinkworkSweep
from benchmarks.peers.mechanism_package import MechanismPackage
from benchmarks.peers.numpy_dyads import NumpyDyads
from benchmarks.peers.peer import Peer
from benchmarks.peers.pylinkage_numba import PylinkageEnsemble, PylinkageStepFast
from benchmarks.peers.scipy_fsolve import ScipyFsolve
from benchmarks.peers.solvespace import Solvespace

__all__ = ["PEERS", "chosen"]

PEERS: tuple[Peer, ...] = (
    LinkworkSweep(certify=True),
    LinkworkSweep(certify=False),
    LinkworkFamily(certify=True),
    LinkworkFamily(certify=False),
    LinkworkFamily(certify=True, specialised=True),
    LinkworkFamily(certify=False, specialised=True),
    PylinkageStepFast(),
    PylinkageEnsemble(),
    NumpyDyads(),
    CasadiNewton(compiled=True),
    CasadiNewton(compiled=False),
    ScipyFsolve(),
    ExudynStatics(),
    Solvespace(),
    KinepyGroups(),
    MechanismPackage(),
)


def chosen(parts: list[str]) -> list[Peer]:
    """The peers whose name contains one of these; all without any.

    Raises
    ------
    ValueError
        If a part is in no name.
    """
    for part in parts:
        if not any(part in peer.name for peer in PEERS):
            names = ", ".join(peer.name for peer in PEERS)
            raise ValueError(f'no peer is called "{part}" (there are: {names})')
    return [peer for peer in PEERS if not parts or any(part in peer.name for part in parts)]
