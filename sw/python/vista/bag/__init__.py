"""Bags of ROS 2 with what a run saw and found, in MCAP: for Foxglove, ROS, and `vista run` itself."""
