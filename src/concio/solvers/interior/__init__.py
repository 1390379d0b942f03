"""The engine: interior point on the Coulomb problem, exact finish, homotopy."""
