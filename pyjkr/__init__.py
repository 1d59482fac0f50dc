"""Adhesive impacts with reduced stiffness: LIGGGHTS decks from scene files, runs, and their comparison with an oracle."""
