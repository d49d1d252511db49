"""A body pushed sideways up an inclined plane with friction, or the plane pushed under the body.

Sources: Coulomb (1785); benchmark CGS-4 of NAFEMS report R0081 (F/G at tan(alpha) = 0.1).
"""

import numpy as np


def limit_ratio(slope, friction):
    """Sideways force over normal force F/G = (tan(alpha) + mu)/(1 - mu tan(alpha)) at which sliding
    uphill starts.

    ``slope`` is tan(alpha), negative downhill. Raises ``ValueError`` for mu < 0, or where no force
    suffices (mu tan(alpha) >= 1).
    """
    slope, friction = np.asarray(slope, dtype=float), np.asarray(friction, dtype=float)
    if np.any(friction < 0) or np.any(friction * slope >= 1):
        raise ValueError(f"no force suffices on a slope of {slope} with a friction of {friction}")
    return (slope + friction) / (1 - friction * slope)
