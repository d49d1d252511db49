"""Compare with the thesis's numbers: thesis_comparison.py REFERENCE.csv TABLE.csv [RESULTS/... as for figure.py]"""
