/* Places that turn about a point: the eye and the lights. Vectors of three, in the scene's left-handed coordinates. */
#ifndef KAGE_LOOK_ORBIT_H
#define KAGE_LOOK_ORBIT_H

/* Turn `place` about the axis `up` through `about` by `turn`, then tilt it towards `up` by `tilt`, in radians. Its
 * distance stays, and it keeps a degree away from the axis. */
void orbit_turn(double place[3], const double about[3], const double up[3], double turn, double tilt);

/* Move it along the line from `about`, to `factor` times its distance. */
void orbit_approach(double place[3], const double about[3], double factor);

/* Move both the eye and what it looks at in the plane of the picture, in scene units. */
void orbit_pan(double from[3], double at[3], const double up[3], double right, double above);

double orbit_distance(const double a[3], const double b[3]);

#endif
