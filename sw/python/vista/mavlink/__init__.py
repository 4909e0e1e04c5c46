"""What autopilots are told, as MAVLink messages; these and their times are libvista's (vista/mavlink.h).

sighting   what one frame found, from a line of obstacles.jsonl
link       libvista's link to one autopilot
transport  where the bytes go: UDP or a serial line
replay     a recording of obstacles, sent as it was seen
"""
