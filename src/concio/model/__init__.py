"""What an engineer describes: blocks, mortar, joints, supports, loads; immutable, checked when made."""
