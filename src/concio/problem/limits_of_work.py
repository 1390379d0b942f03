"""Every limit of work at which an analysis leaves something out, gives up, or hands on to another method.

A limit that is met is reported with the answer. Sizes from which one way of computing the same is quicker than another,
and rounds of refinement that end where they no longer help, stay with their method. All are numbers, of pairs unless
the sentence says of what; none depends on a clock.
"""

from __future__ import annotations

# -- what is done without being asked for -----------------------------------------------------------------------------

LARGEST_PATH = 400
"""Up to this number of pairs the exact path is followed by default: some five events a pair, each a linear system."""

LARGEST_SEARCH = 15_000
"""Collapse states are searched for in problems of up to this number of pairs: about a minute there."""

UNASKED_IN_SPACE = 1_500
"""Up to this number of pairs in space collapse states are searched for by default, and the least load that was not
reached is applied in one step: beyond, the few programmes of some seconds end far from a state."""

UNASKED_SPREAD = 4_000
"""Up to this number of pairs load steps with the pressure of joints spread over them are taken by default where joints
twist: they take about as long as the load steps at their corners."""

MOST_SLIDING = 150
"""Largest number of parts that slide which an assessment in the plane follows; in space, where a curve takes many
programmes, it follows none."""

UNASKED_WORK = 40_000
"""Linear programmes times pairs of the search for collapse states where it is not asked for: some five seconds."""

UNASKED_CONES = 15_000
"""The same of a limit load in space: a cone programme costs three times a linear one, and further starts end within a
thousandth of the first."""

LARGEST_MARGIN = 10_000
"""Up to this number of pairs the friction margin is found by default: it takes some twenty linear programmes."""

LARGEST_EXISTENCE = 2000
"""Largest number of pairs for which summaries report the paper's sufficient condition (a linear programme)."""

LARGEST_HOLDING = 20_000
"""Largest number of pairs for which the forces that could hold a structure are worked out (a linear programme)."""

EXACT_PAIRS = 150
"""Up to this number of contact pairs a path in the plane is followed event by event, unless stated otherwise."""

# -- one load step ----------------------------------------------------------------------------------------------------

NEIGHBOUR_PIVOTS = 500
"""Largest number of pivots of one path back from a neighbour in friction, beside one for every ten pairs."""

NEIGHBOURS_PIVOTS = 10_000
"""Largest number of pivots of all paths back from neighbours in friction."""

NEIGHBOURS_WORK = 40_000_000
"""The same times the number of pairs."""

NEIGHBOUR_HALVINGS = 6
"""Times the way back from a neighbour to the structure's own friction may be halved."""

COLD_PAIRS = 3000
"""Largest number of pairs for which the first step of relaxation is tried by pivoting from nothing."""

RELAXATION_WORK = 3_000_000
"""Largest number of pivots in one step of relaxation times the number of pairs."""

HOMOTOPY_ITERATIONS = 300
"""Largest number of iterations of the homotopy in dilatancy."""

LAW_ROUNDS = 300
"""Largest number of times the constants of joint laws are evaluated again at an answer."""

# -- programmes of statics, and proofs --------------------------------------------------------------------------------

PROGRAMME_ITERATIONS = 200
"""Largest number of iterations of the interior point of a linear programme."""

CONE_ITERATIONS = 120
"""Largest number of iterations of a cone programme."""

FRICTION_PROGRAMMES = 200
"""Largest number of linear programmes by which the least friction is found."""

COLLAPSE_WORK = 100_000
"""No further start of the search for collapse states is made once linear programmes times pairs have come to this."""

MOST_BITS = 100_000
"""Bits of a solution in fractions beyond which it is given up."""

# -- load paths -------------------------------------------------------------------------------------------------------

LARGEST_VERTEX = 400
"""Largest number of unknowns of the dense complementarity problem tried where a path meets several events at once."""

MOST_RESTARTS = 200
"""Finite steps (jumps and restarts) taken on one path before these count as too many events."""

SMALL_PATH = 1000
"""Up to this number of pairs the first event of a path from rest is found by whatever it takes: some seconds."""

BREAK_HALVINGS = 50
"""Halvings by which the load is looked for that is left when a tie breaks under the motion of a point."""

BREAK_STEPS = 60
"""Largest number of load steps by which the break of a tie is located on a path in steps."""

# -- steps of motions -------------------------------------------------------------------------------------------------

STEP_FACTORISATIONS = 14
"""Factorisations of a step at most before other methods are tried."""

SOFTER_FACTORISATIONS = 300
"""Factorisations of a step in space with joints that give way more, where rounds with its own do not arrive."""

STEP_PIVOTS = 20
"""Pivots for each pair that are tried where nothing else decides a step."""

STEP_PAIRS = 120
"""Largest number of pairs of the small problem that settles a step."""

STEP_PROBLEMS = 12
"""Largest number of small problems that settle a step."""

MOTION_STEPS = 20_000_000
"""Largest number of steps of a motion: one block takes some hours for them, and their histories a gigabyte."""

LET_GO_WORK = 4_000_000
"""Steps of a motion from rest, times unknowns and pairs, that are spent on a load step that stays undecided."""

LEAST_LET_GO = 500
"""Number of steps that are spent on it in any case."""

MOST_LET_GO = 10_000
"""Largest number of steps that are spent on it."""
