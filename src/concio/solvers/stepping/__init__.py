"""One step of a motion: a contact problem with definite stiffness whose states are nearly those of the step before."""
