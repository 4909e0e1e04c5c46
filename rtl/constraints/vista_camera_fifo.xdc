# SPDX-License-Identifier: Apache-2.0
# Constraints of vista_camera_fifo for Vivado: read_xdc -ref vista_camera_fifo. The clocks of both sides are defined before.
set pixel_period [get_property -min PERIOD [get_clocks -of_objects [get_ports pixel_clk_i]]]
set period [get_property -min PERIOD [get_clocks -of_objects [get_ports clk_i]]]
set shorter [expr {min($pixel_period, $period)}]

# Of a pointer one bit changes at a time: all of them arrive within a clock of the side that they come from.
set_max_delay -datapath_only $shorter -from [get_cells write_gray_q_reg[*]] -to [get_cells write_gray_meta_q_reg[*]]
set_max_delay -datapath_only $shorter -from [get_cells read_gray_q_reg[*]] -to [get_cells read_gray_meta_q_reg[*]]
set_bus_skew $shorter -from [get_cells write_gray_q_reg[*]] -to [get_cells write_gray_meta_q_reg[*]]
set_bus_skew $shorter -from [get_cells read_gray_q_reg[*]] -to [get_cells read_gray_meta_q_reg[*]]
set_property ASYNC_REG true [get_cells {write_gray_meta_q_reg[*] write_gray_read_q_reg[*]}]
set_property ASYNC_REG true [get_cells {read_gray_meta_q_reg[*] read_gray_write_q_reg[*]}]

# What is read was written two clocks of the reader before.
set_max_delay -datapath_only $period -from [get_clocks -of_objects [get_ports pixel_clk_i]] -to [get_cells u_memory/read_q_reg[*]]
