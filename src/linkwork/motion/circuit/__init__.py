"""Circuits and branches: what can be reached without taking the mechanism apart."""
