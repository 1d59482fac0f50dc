"""Ballistic packing of adhesive spheres: Chen, Liu and Li 2019, sec. 4.

scene -> column -> deck -> run -> bed: what is packed, where the spheres start, LIGGGHTS' input, the run, what came to rest.
"""
