"""Emulators: what a sweep's scenes answered, between them, in a millisecond and with its error.

Question -> basis -> answer. A scene becomes a point of the sweep's box, a modulus factor and a time
(`question`); Gaussian processes give the principal components of each quantity there (`basis`,
`process`, `fitting`); these give histories, profiles and their bands (`model`). `explorer` writes a
page of it.
"""
