"""Pages, pictures and tables of scores."""
