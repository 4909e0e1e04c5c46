// SPDX-License-Identifier: Apache-2.0
-f rtl/vista_stereo_core.f
rtl/src/vista_pixel_writer.sv
rtl/src/vista_rows.sv
rtl/src/vista_smooth.sv
rtl/src/vista_reduce.sv
rtl/src/vista_frame_guard.sv
rtl/src/vista_levels.sv
rtl/src/vista_pyramid.sv
rtl/src/vista_rectify_pkg.sv
rtl/src/vista_rectify_map.sv
rtl/src/vista_rectify_points.sv
rtl/src/vista_rectify_ring.sv
rtl/src/vista_rectify_rows.sv
rtl/src/vista_rectify_sample.sv
rtl/src/vista_rectify.sv
rtl/src/vista_front_end.sv
