"""Every tolerance that decides what is said of an answer, with what it means.

Numbers that only steer a method (step lengths, rounds of refinement) stay with the method; limits of work have a table
of their own (:mod:`concio.problem.limits_of_work`). What stands here decides whether a thing *is* something:
certified, exact, rough, zero. All are relative: forces to the total load or the largest force, lengths to the largest
displacement, velocities to the largest velocity; the sentence of each says to which.
"""

from __future__ import annotations

import numpy as np

# -- the problem ----------------------------------------------------------------------------------------------------

SMOOTH = 1e-12
"""Friction coefficients up to this are none, and c - mu T below this share of c is zero."""

NO_MOVEMENT = 1e-30
"""A support that is moved by less than this stays where it is [m]."""

# -- answers --------------------------------------------------------------------------------------------------------

CERTIFIED = 1e-9
"""Largest worst entry of the certificate of an answer that may be called solved; relative to load and displacement."""

BALANCE_ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Share of |K| |u| by which rounding of displacements may put the balance at a node wrong."""

GRANTED = 1e-7
"""Largest share of the load that is granted to rounding."""

EXACT = 1e-11
"""Largest natural-map residual of an exact answer: its states are the right ones, what is left is rounding.

Relative to the largest force and displacement, in units of the problem's own. A structure that drifts off may come
near, never here."""

AT_BOUND = 1e-9
"""Forces, gaps and slips below this share of the largest count as zero where the state of a pair is read off."""

CONSTANTS_STAY = 1e-10
"""Largest change of a constant of joint laws, relative to the largest of its kind at first, up to which constants that
depend on the answer belong to it."""

STEP_SETTLED = 1e-10
"""Violation of a joint law up to which a step of a motion is solved; relative to the force and length of the step."""

STEP_GOOD = 1e-11
"""Residual below which a step of a motion is taken without looking further; relative like :data:`STEP_SETTLED`."""

ENERGY_ROUNDING = 1e-9
"""Share of the size of a model by which all weights are lifted with an energy that counts as none in a motion: places
are known to rounding of this size, and a step is certified to the same share of the loads."""

RELAXED = 1e-10
"""Natural-map residual up to which a step of viscous relaxation is solved."""

MOVING_ON = 1e-9
"""Natural-map residual up to which a step that looks for an unbounded motion is solved."""

STILL_PAIR = 1e-9
"""Relative velocities of a pair up to this share of the largest are none, in an unbounded motion."""

RIGID_BODY = 1e-6
"""Largest scaled displacement, beside an unbounded motion, that is taken for none; elastic bodies under load move by
about one."""

SLIDES = 1e-6
"""Share of the largest slip of a step from which on a pair slides in an unbounded motion."""

RESTING = 1e-6
"""Largest scaled displacement that is tried as zero; elastic bodies under load move by about one."""

ACCURATE = 1e-10
"""Largest certificate entry of a state from which a path goes on: its error would stay in the balance of energy."""

UNLOADED = 1e-12
"""Share of the largest normal force below which that of a joint is zero: it has no centre of pressure."""

# -- ties and loads -------------------------------------------------------------------------------------------------

BROKEN_TIE = 1e-9
"""A tie is broken where it is stretched to its break elongation, but for this share of it."""

SLACK_TIE = 1e-9
"""A tie with less than this share of the largest force beside it is slack; one this near its most carries its most."""

BREAK_LOCATED = 1e-8
"""Share of its elongation at break within which a tie breaks, on a path in steps."""

APPLIED = 1e-9
"""A factor that falls short of what was asked for by less than this share of its change was reached."""

# -- proofs ---------------------------------------------------------------------------------------------------------

ADMISSIBLE = 1e-9
"""Largest violation of a motion, relative to its largest velocity, that is accepted in a proof."""

BALANCED = 1e-11
"""Largest imbalance of forces, relative to the load, that prove that the loads can be carried: well below the power at
which a mechanism proves the contrary, so that both cannot be shown."""

CLEARLY = 1e-9
"""A power counts as positive when it exceeds this share of the sum of |f_i v_i|."""

CHECKED = 1e-8
"""Largest residual, violation and duality gap of a limit load or collapse state that counts as checked from both
sides; largest entry of the certificate of homogenised moduli."""

PROGRAMME_SETTLED = 1e-11
"""Residual of forces in balance, and of an admissible motion, at which a programme may stop that has its answer."""

PROGRAMME_ROUNDING = 1e-14
"""Share of the total load that forces may leave unbalanced, or exceed strengths by, before they are balanced again."""

CONE_TARGET = 1e-11
"""Residuals and relative gap at which a cone programme ends."""

FROZEN_TARGET = 1e-10
"""The same where strengths are frozen: forces make the next strengths, motions are known to a share of ``MOVES``, and
the state that goes with one is proved by itself."""

PROGRAMME_TARGET = 1e-12
"""Residuals and relative gap at which the interior point of a linear programme ends."""

STILL_CLOSE = 1e-5
"""Residuals and relative gap that are worth being rechecked as an answer where a linear programme ends by itself."""

PROGRAMME_ENOUGH = 1e-7
"""Residual of the equations at which a linear programme may end; the rest is taken away afterwards."""

NEARLY_BALANCED = 1e-6
"""Residual below which the forces of the linear programme are balanced once more, to tell rounding from collapse."""

FRICTION_ROOM = 1e-9
"""Friction, over the total load, that a pair that slips may have beside that of its direction: the direction is known
to rounding only, and no forces exactly along it may be in balance. Well below what counts as checked."""

MOVES = 1e-8
"""Relative velocities above this share of the largest count as opening or slipping in a collapse state."""

WIDE_BRACKET = 1e-5
"""Distance of two bounds, relative to the upper one, from which on the least friction is not called settled."""

CONTRADICTION = 1e-7
"""Residual of the linear equations of a cell from which on the states of its joints forbid a strain."""

DEAD_POWER = 1e-6
"""Share of its own power by which the dead load has to exceed what is absorbed to be proven not to be carried."""

BONDED_LEFT = 1e-8
"""Residual of the linear equations above which a wall whose joints all stick has no state."""

# -- studies --------------------------------------------------------------------------------------------------------

SAME_VALUE = 1e-10
"""Values of an output that differ by less than this share of them are the same: what differs is rounding."""

NO_REACTION = 1e-12
"""Share of the largest force of all reactions below which a component of one is zero."""
