// What every draft has: material, joint, gravity, step and end of a motion.
#pragma once

#include "openclose/draft/annotated_text.h"

namespace openclose {

struct DraftMaterial {
  std::string_view name;
  double density = 0.0;           ///< [kg/m3]
  double normal_stiffness = 0.0;  ///< [Pa/m]
  double shear_stiffness = 0.0;   ///< [Pa/m]
  double friction_angle = 0.0;    ///< [deg], as it is written
  double cohesion = 0.0;          ///< [Pa]
};

/// The top of the file. \param tilt  [deg] of gravity, which pulls to the right then
void begin(AnnotatedText& text, const std::string& title, double tilt);
/// The material, and the joint between its blocks.
void add_material(AnnotatedText& text, const DraftMaterial& material);
/// Step and end of `openclose run`; fos needs neither.
void add_motion(AnnotatedText& text, double step, double end);

}  // namespace openclose
