"""Load paths: event by event, in steps, over jumps."""
