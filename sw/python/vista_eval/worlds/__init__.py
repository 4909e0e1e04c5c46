"""What the flights and the labelled scenes show: shapes -> things -> scenes."""
