"""A study without physics, and ways to sweep it: for tests of the machinery alone."""
