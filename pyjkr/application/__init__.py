"""Scenes of many particles: scene file -> `Situation` for the plan -> deck -> run -> few numbers and a picture.

`scene` reads the file, `situation` says what may happen in it, `places` and `shapes` put spheres and walls, `laws` gives the
numbers of the contact law at a plan, `deck` writes, `analysis` measures, `picture` draws.
"""
