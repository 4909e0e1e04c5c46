"""Flights and measured pairs on disk: writers and readers side by side."""
