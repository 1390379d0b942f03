"""The window: a page in the browser, served from this machine, to draw, load, ask and report."""
