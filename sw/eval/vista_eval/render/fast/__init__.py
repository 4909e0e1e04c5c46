"""Renders by casting rays: where they meet surfaces and what lies in shadow. The same ray always finds the
same, so the cameras share every speckle."""
