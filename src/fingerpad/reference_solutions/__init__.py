"""Analytic solutions of contact, elasticity and linear viscoelasticity, to check a solver against.

The package stands alone: numpy and scipy (the weak form: scikit-fem), nothing of the rest of
``fingerpad``. One module a subject:

================== ===========================================================================
hertz              rigid or elastic cylinder on a half-plane: width, pressure, stresses below
westergaard        sinusoidal surface on a half-plane, partial contact
cattaneo_mindlin   partial slip of the Hertz line contact, loaded and unloaded
punch              flat rigid punch with sharp edges
incline            a body pushed up an inclined plane with friction
friction_plate     numbers of a plate that lifts off, slips and sticks (SSNV128)
layered            thin bonded incompressible layer; stack of bonded layers under a cosine load
layered_contact    a rigid profile pressed on a stack of layers (numerical, one Fourier kernel)
lame               thick cylinder under internal and external pressure
cook               published and recomputed numbers of Cook's membrane
prony_point        a material point with a Prony series: relaxation, creep, strain ramps, cycles
lee_radok          viscoelastic line contact while the contact grows
ting               hereditary integrals for any contact with one Prony series
phillips_johnson   the skin as an elastic half-plane: stresses and strain energy below any pressure
waterbed           the fingertip as a fluid under a membrane, pressed by a plate or cylinder
manufactured       displacement fields with their body forces, small and finite strain
weak_form          the equations that are solved and their tangent, in scikit-fem's form language
================== ===========================================================================

Any consistent set of units will do; the docstrings use the SI. Forces and moments of plane problems
are per unit length out of plane. Pressures are positive in compression, stresses positive in
tension.
"""
