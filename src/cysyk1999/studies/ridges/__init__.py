"""Strokes over pads with ridges."""
