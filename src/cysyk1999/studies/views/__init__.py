"""Pictures of what happens inside: fields, meshes, maps over a stroke, responses, and how the whole
compares with the thesis.
"""
