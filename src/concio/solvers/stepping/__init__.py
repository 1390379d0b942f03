"""One step of a motion: a contact problem with definite stiffness whose states are nearly those of the step before.

Why not :class:`concio.solvers.states.settle.Settler`, which settles states as well: it lives as long as K and C do, and
adds springs to bodies that float. In a step nothing floats, and C has new values each time, so that its factor and
columns would be made again. Both end exactly on the same steps; with the settler a step of a rocking block takes 6.6
times as long (6.1 ms against 0.9), of walls of 27 blocks 3.2 times rigid and 2.7 times elastic. The small problem of
the pairs in question is the same idea in both.
"""
