"""Moduli, relaxation and friction from what was measured."""
