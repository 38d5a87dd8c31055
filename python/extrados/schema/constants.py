"""Constants that decks, analyses and figures share; those of nature the core has as well (a test compares them)."""

#: Standard gravity [m/s^2]
GRAVITY = 9.80665

#: What analyses blocks in space, as refusals of structures without a plane section state it
IN_SPACE = "limit analysis (`tilt`, `thrust`, `sweep`, `survey`, `imperfections`), `dem`, `dem-domain` and `dem-fragility` can analyse its solids in space"
