"""Objects of a model in Python, their measures and derivatives, meshes, sketches."""
