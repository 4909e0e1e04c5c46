"""What a run is shown as: pictures of its frames, plots, and the page of the report."""
