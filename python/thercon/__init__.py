"""Decks, runs and results of thercon from Python."""
