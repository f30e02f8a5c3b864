#include "harness.h"

namespace openclose::verification {

void projectile(Report&);
void mass_properties(Report&);
void free_spin(Report&);
void momentum(Report&);
void incline(Report&);
void static_hold(Report&);
void cohesion_threshold(Report&);
void stopping(Report&);
void pulse_under_block(Report&);
void shaken_incline(Report&);
void recorded_motion(Report&);
void toppling_chart(Report&);
void amplification(Report&);
void contact_damping(Report&);
void second_order_integrators(Report&);
void conserving_bounces(Report&);
void bounce(Report&);
void small_vibration(Report&);
void collisions(Report&);
void rocking_block(Report&);
void planar_wedge(Report&);
void parallel_planes(Report&);
void goodman_bray(Report&);
void two_joint_sets(Report&);
void four_block_corner(Report&);
void corner_over_joint(Report&);
void critical_friction(Report&);
void arch(Report&);
void overhang(Report&);
void column(Report&);
void tilt(Report&);
void no_energy_from_nothing(Report&);
void invariance(Report&);

const std::vector<Case>& cases() {
  static const std::vector<Case> list = {
      {"A1", "projectile", &projectile},
      {"A2", "mass properties from the response to a load", &mass_properties},
      {"A3", "free spin", &free_spin},
      {"A4", "momentum of a free cluster", &momentum},
      {"B1", "block on an incline", &incline},
      {"B2", "static hold", &static_hold},
      {"B3", "cohesion threshold", &cohesion_threshold},
      {"B4", "initial velocity to a stop", &stopping},
      {"B5", "sliding and toppling of a block on a plane", &toppling_chart},
      {"C1", "block on a base with a rectangular pulse", &pulse_under_block},
      {"C2", "block on an incline under harmonic shaking", &shaken_incline},
      {"C3", "block on an incline under a record", &recorded_motion},
      {"D1", "amplification matrix of one block on a spring", &amplification},
      {"D1c", "contact damping of one block on one contact", &contact_damping},
      {"D1i", "amplification by the integrators of second order", &second_order_integrators},
      {"D2", "bounce on a contact", &bounce},
      {"D2i", "bounces with path-averaged forces", &conserving_bounces},
      {"D3", "small vibration of a block on two springs", &small_vibration},
      {"D4", "collisions", &collisions},
      {"D5", "rocking block", &rocking_block},
      {"E1", "planar wedge", &planar_wedge},
      {"E3", "plane failure on parallel joints", &parallel_planes},
      {"E4", "toppling columns of Goodman and Bray", &goodman_bray},
      {"E5", "slope with two joint sets", &two_joint_sets},
      {"E6", "four blocks that meet in one corner", &four_block_corner},
      {"E6", "a corner that stands on a joint", &corner_over_joint},
      {"E6", "critical friction angle of jointed slopes", &critical_friction},
      {"F1", "smallest thickness of an arch", &arch},
      {"F2", "overhang of a stack", &overhang},
      {"F3", "forces and modes of a column", &column},
      {"F4", "a column tips", &tilt},
      {"H1", "no energy from nothing", &no_energy_from_nothing},
      {"I", "invariance: units, mirror, turn, place, frame, order, strangers, restart", &invariance},
  };
  return list;
}

}  // namespace openclose::verification
