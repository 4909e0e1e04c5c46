// SPDX-License-Identifier: Apache-2.0
rtl/src/vista_stereo_pkg.sv
rtl/src/vista_memory.sv
rtl/src/vista_camera_fifo.sv
rtl/src/vista_dvp.sv
rtl/src/vista_pair_sync.sv
rtl/src/vista_camera_pair.sv
