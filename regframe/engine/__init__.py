"""Runs presets: stages, levels, samples, starts and the objective in between."""
