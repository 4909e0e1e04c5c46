# SPDX-License-Identifier: Apache-2.0
# Constraints of vista_camera_fifo in SDC, for an instance u_camera_fifo; `period` is that of the faster clock, in ns.
set period 8.0
set_max_delay $period -from [get_cells *u_camera_fifo/write_gray_q*] -to [get_cells *u_camera_fifo/write_gray_meta_q*]
set_max_delay $period -from [get_cells *u_camera_fifo/read_gray_q*] -to [get_cells *u_camera_fifo/read_gray_meta_q*]
set_min_delay 0 -from [get_cells *u_camera_fifo/write_gray_q*] -to [get_cells *u_camera_fifo/write_gray_meta_q*]
set_min_delay 0 -from [get_cells *u_camera_fifo/read_gray_q*] -to [get_cells *u_camera_fifo/read_gray_meta_q*]
set_max_delay $period -from [get_cells *u_camera_fifo/u_memory/mem*] -to [get_cells *u_camera_fifo/u_memory/read_q*]
