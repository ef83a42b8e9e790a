"""Motions in time of Linkwork, Exudyn and a stabilised integrator."""
