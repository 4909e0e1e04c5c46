-f rtl/vista_stereo_core.f
rtl/src/vista_pixel_writer.sv
rtl/src/vista_rows.sv
rtl/src/vista_smooth.sv
rtl/src/vista_reduce.sv
rtl/src/vista_frame_guard.sv
rtl/src/vista_levels.sv
rtl/src/vista_pyramid.sv
