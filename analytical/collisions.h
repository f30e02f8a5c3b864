// Masses in a row that collide on linear springs or plastically (case D4). Mass i at x_i, to the right of mass i - 1; g_i its gap to mass i - 1,
// compressed while negative, then pushing both apart with K |g_i|. No gravity. Masses, K > 0; gaps at the start >= 0.
#pragma once

#include <vector>

namespace openclose::analytical {

struct MassRow {
  std::vector<double> masses;      // [kg]
  std::vector<double> velocities;  // [m/s] to the right
  std::vector<double> gaps;        // [m] one less
  double stiffness = 1;            // K [N/m] of each contact
};

struct MassRowState {
  std::vector<double> displacements;  // [m]
  std::vector<double> velocities;     // [m/s]
};

/// Two masses after an elastic collision, whatever the spring: v1' = [(m1 - m2) v1 + 2 m2 v2]/(m1 + m2), and the other way round.
std::vector<double> elastic_collision(const MassRow& pair);
/// Time [s] that the contact of two masses lasts: pi sqrt(m*/K), m* = m1 m2/(m1 + m2).
double contact_duration(const MassRow& pair);
/// CVODE with every closing and opening of a contact located.
MassRowState elastic_row(const MassRow& row, double time, double relative_tolerance = 1e-13);
/// Masses that meet stay together with their common velocity: momentum over mass. Event by event.
MassRowState plastic_row(const MassRow& row, double time);

}  // namespace openclose::analytical
