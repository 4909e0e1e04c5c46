/* What the autopilot says of the vehicle's motion, as MAVLink messages: the camera's pose at the moment of an exposure.
 *
 *   vista_vehicle vehicle;
 *   vista_vehicle_start(&vehicle, &parameters.mavlink, 0);
 *   whenever bytes arrive:
 *     vista_vehicle_receive(&vehicle, now_ns, bytes, count);
 *   for each frame:
 *     vista_vehicle_at(&vehicle, exposure_ns, &motion);
 *     frame.pose = motion.pose_known ? &motion.pose : NULL;
 *
 * HEARTBEAT, ATTITUDE_QUATERNION and LOCAL_POSITION_NED of component 1 of the system mavlink.system_id count, in frames of MAVLink 1
 * and 2. The world is NED: x north, y east, z down. The mount of the camera is that of [mavlink]; the camera counts as
 * being where the autopilot says that the vehicle is.
 *
 * The autopilot times its messages on a clock of its own. The message that took least time on its way tells how that
 * clock and ours differ; `delay_ns`, which the caller knows or measures, is what it took. */
#ifndef VISTA_VEHICLE_H
#define VISTA_VEHICLE_H

#include <stdbool.h>
#include <stdint.h>

#include "vista/api.h"
#include "vista/parameters.h"
#include "vista/status.h"
#include "vista/types.h"

VISTA_BEGIN

#define VISTA_VEHICLE_KEPT 64 /* messages of each kind: a second and more at the usual rates */
#define VISTA_VEHICLE_FRAME_BYTES 300

/* What an ATTITUDE_QUATERNION says. */
typedef struct vista_vehicle_attitude {
  int64_t boot_ns; /* on the autopilot's clock */
  double quaternion[4]; /* w, x, y, z: from the body, FRD, to NED */
  double rate_rad_s[3]; /* in the body */
} vista_vehicle_attitude;

/* What a LOCAL_POSITION_NED says. */
typedef struct vista_vehicle_position {
  int64_t boot_ns;
  double position_m[3], velocity_m_s[3]; /* NED */
} vista_vehicle_position;

/* What is known of the vehicle's motion, in memory of the caller. Its members are the library's own. */
typedef struct vista_vehicle {
  double body_from_camera[9];
  int32_t system_id;
  int64_t delay_ns;
  bool timed;
  int64_t offset_ns, offset_at_ns; /* our clock minus the autopilot's, and when that was last looked at */
  int32_t attitude_count, position_count; /* received since the clock last leapt; the newest is count - 1 */
  vista_vehicle_attitude attitudes[VISTA_VEHICLE_KEPT]; /* number k at k % VISTA_VEHICLE_KEPT */
  vista_vehicle_position positions[VISTA_VEHICLE_KEPT];
  bool offered; /* the autopilot is in the mode in which it flies what it is told, and armed, */
  int64_t offered_ns; /* as of the last heartbeat; 0: none came */
  int32_t used;
  uint8_t bytes[VISTA_VEHICLE_FRAME_BYTES]; /* that wait for the rest of their frame */
} vista_vehicle;

/* The vehicle at one moment. What is not known is zero. */
typedef struct vista_vehicle_motion {
  bool pose_known, velocity_known, up_known;
  vista_pose pose; /* of the camera in NED */
  double velocity_m_s[3]; /* NED */
  double up_world[3]; /* 0, 0, -1 */
} vista_vehicle_motion;

/* Begins without any message. VISTA_ERROR_RANGE: a parameter, or a delay that is not from 0 to a second. */
VISTA_API vista_status vista_vehicle_start(vista_vehicle *vehicle, const vista_mavlink_params *params,
                                           int64_t delay_ns);

/* Takes bytes of a stream, cut anywhere. What is damaged, of others, or not finite is passed over. A clock of the
 * autopilot that leaps begins anew. VISTA_ERROR_ARGUMENT: null, or a count below 0. */
VISTA_API vista_status vista_vehicle_receive(vista_vehicle *vehicle, int64_t now_ns, const uint8_t *bytes,
                                             int32_t count);

/* The motion at t_ns, on the clock of now_ns: between the messages before and after, which may be half a second apart;
 * at most 0.2 s past the last one it goes on as that says. Farther off it is not known. */
VISTA_API vista_status vista_vehicle_at(const vista_vehicle *vehicle, int64_t t_ns, vista_vehicle_motion *motion);

/* Whether the autopilot flies setpoints now (vista_mavlink_fly): armed and in the mode OFFBOARD of PX4 or GUIDED of
 * ArduPilot, as a heartbeat said in the last 3 s. Nobody but the pilot, or who plays him, takes it into that mode. */
VISTA_API bool vista_vehicle_follows(const vista_vehicle *vehicle, int64_t now_ns);

VISTA_END

#endif
