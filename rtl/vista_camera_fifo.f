// SPDX-License-Identifier: Apache-2.0
rtl/src/vista_memory.sv
rtl/src/vista_camera_fifo.sv
