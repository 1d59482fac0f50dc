"""A scene in, the cheapest deck that is still right out: which effects, how soft, which time step, what it costs.

`situation` says what may happen in a scene; `effects`, `softening` and `steps` decide, each with a number and its source;
`plan` puts the decisions together.
"""
