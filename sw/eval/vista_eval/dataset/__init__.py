"""Flights and labelled scenes on disk: writers and readers side by side."""
