"""The reproduction of Cysyk (1999), *Skin Dynamics in the Tactile Sensing of Shape*, made with
:mod:`fingerpad`.
"""
