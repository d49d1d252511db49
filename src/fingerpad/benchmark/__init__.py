"""Published measurements of touch, and how near any model comes to them.

:mod:`rows` reads the measurements, :mod:`score` scores predictions of them, :mod:`predict` makes
those of this model and :mod:`half_space` those that it must beat.
"""
