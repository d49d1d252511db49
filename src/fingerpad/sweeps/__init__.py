"""Sweeps: from one scene to thousands, with nothing lost. Language -> design -> forecast -> batches
-> one labelled dataset.
"""
