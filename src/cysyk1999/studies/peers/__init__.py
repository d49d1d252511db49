"""One press by public finite element packages, at their best and with contact of their own, and by
this one.
"""
