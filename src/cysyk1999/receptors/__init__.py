"""Fits, recordings and sensors beside the laws of :mod:`fingerpad.receptors`."""
