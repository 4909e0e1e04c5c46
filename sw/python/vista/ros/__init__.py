"""The node of ROS 2: what a stereo camera publishes goes through the chain, and what is found is published.

Messages cross between rclpy and the rest as bytes (CDR), and rosbags reads and writes them as those of a bag:
a topic is read by what reads bags (vista.sequence.bag), and published by what writes them (vista.bag).
"""
