#include "openclose/draft/common_tables.h"

#include <cmath>

#include "openclose/scene/angle.h"

namespace openclose {

void begin(AnnotatedText& text, const std::string& title, double tilt) {
  constexpr double gravity = 9.81;  // [m/s2]
  text.key("title", std::string_view(title));
  if (tilt == 0.0) {
    text.key("gravity_m_per_s2", Vec2(0.0, -gravity));
  } else {
    text.comment(
        "The table on which it stands is tilted: gravity has a part along the beds. What fos --increase gravity_x finds comes on top of that part; "
        "for the coefficient of a level table write [0, -9.81].");
    text.key("gravity_m_per_s2", Vec2(gravity * std::sin(radians(tilt)), -gravity * std::cos(radians(tilt))));
  }
}

void add_material(AnnotatedText& text, const DraftMaterial& material) {
  text.table("material");
  text.key("name", material.name);
  text.key("density_kg_per_m3", material.density);
  text.table("joint", "Measure or estimate these; openclose fos divides the strength and asks when it fails");
  text.key("materials", std::vector<std::string_view>{material.name, material.name});
  text.key("normal_stiffness_pa_per_m", material.normal_stiffness);
  text.key("shear_stiffness_pa_per_m", material.shear_stiffness);
  text.key("friction_angle_deg", material.friction_angle);
  text.key("cohesion_pa", material.cohesion);
  text.key("tensile_strength_pa", 0.0);
}

void add_motion(AnnotatedText& text, double step, double end) {
  text.blank_line();
  text.comment("The rest is for openclose run, which follows the blocks in time; openclose fos needs none of it.");
  text.table("method");
  text.key("contact", std::string_view("soft"));
  text.key("start", std::string_view("settled"));
  text.table("step");
  text.key("dt_s", step);
  text.table("end");
  text.key("time_s", end);
}

}  // namespace openclose
