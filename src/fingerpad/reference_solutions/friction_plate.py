"""An elastic plate pressed on a rigid plane and pushed along it: lift-off, slip and stick in one
contact.

A square of :data:`SIDE`, plane strain, stands on the rigid plane y = 0; uniform pressures act on
its top and on its left side x = 0, and its right side x = SIDE cannot move sideways. Lengths m,
stresses Pa. Sources: code_aster V6.04.128 (SSNV128, from the French research group on large
deformations, GRECO): ``MEAN_OF_CODES``, given to 5 %. ``CONVERGED`` was recomputed without any
penalty, from the linear equations that a given partition of the contact into lifted, slipping and
sticking nodes leaves, the partition being corrected until Coulomb's and Signorini's conditions held
everywhere: scikit-fem, nine-node elements, small strain, 48 x 48 and 96 x 96 agreeing to 1e-5.
"""

SIDE = 40e-3
YOUNGS_MODULUS, POISSON_RATIO = 130e9, 0.2
FRICTION = 1.0
TOP_PRESSURE, SIDE_PRESSURE = 50e6, 150e6

#: Places along the contact, m, and their sideways displacements, m.
POSITIONS = (0.0, 1.25e-3, 5e-3, 7.5e-3, 11.25e-3)
MEAN_OF_CODES = (2.86e-5, 2.72e-5, 2.28e-5, 1.98e-5, 1.50e-5)
CONVERGED = (2.8603e-5, 2.7226e-5, 2.2868e-5, 1.9807e-5, 1.5414e-5)

#: The plate has lifted off up to the first place, slips up to the second and sticks beyond, m.
LIFTED, SLIPPING = 3.3e-3, 29e-3
