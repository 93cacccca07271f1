"""Runs under way, over the bus: the session, a run, its messages and what they hold."""
