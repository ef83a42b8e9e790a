"""Mechanisms as trees of joints for simulators of robots: MJCF, URDF, SDF."""
