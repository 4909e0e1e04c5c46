/* Sines, tangents and angles that are the same number on every processor, internal to libvista. The functions of C
 * libraries differ in the last digit, and a last digit may tip a choice. These are sums, products and quotients alone,
 * within 1e-15 of the true value. What else the planner asks for is exact by IEEE 754: square roots, fmod, rounding. */
#ifndef VISTA_SRC_ANGLES_H
#define VISTA_SRC_ANGLES_H

/* Of an angle below 1e5 radians in magnitude. */
void vista_plan_sine_cosine(double angle_rad, double *sine, double *cosine);
double vista_plan_tangent(double angle_rad);

/* The angle of a direction, from -pi to pi, as atan2; 0 of no direction. */
double vista_plan_angle(double y, double x);

#endif
