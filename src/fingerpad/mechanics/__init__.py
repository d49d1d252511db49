"""What happens in the skin: kinematics, constitutive updates, contact and quasi-static stepping.

One effect, one room: :mod:`finite_strain` and :mod:`small_strain` are two bodies with the same
verbs,
:mod:`viscoelasticity` is the Prony recurrence both may be given, :mod:`contact` is the exact
unilateral problem,
:mod:`stepping` walks a motion programme with whatever the plan has composed.
"""
