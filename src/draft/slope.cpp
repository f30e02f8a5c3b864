#include <fmt/format.h>

#include <cmath>

#include "openclose/draft/all_drafts.h"
#include "openclose/draft/common_tables.h"
#include "openclose/scene/angle.h"

namespace openclose {
namespace {

void add_joint_set(AnnotatedText& text, const std::string& words, double dip, double spacing) {
  text.table("joint_set", words);
  text.key("dip_deg", dip);
  text.key("spacing_m", spacing);
  text.key("origin_m", Vec2(0.0, 0.0));
}

void add_fixed_line(AnnotatedText& text, const Vec2& from, const Vec2& to) {
  text.table("fixed_line");
  text.key("from_m", from);
  text.key("to_m", to);
}

std::string write_slope(const Dimensions& d) {
  AnnotatedText text;
  const double height = d.of("height_m"), face = d.of("face_angle_deg"), left = -d.of("bench_m"), bottom = -d.of("depth_m");
  const double crest = face == 90.0 ? 0.0 : height / std::tan(radians(face)), right = crest + d.of("behind_m");
  text.comment(
      fmt::format("A rock slope of {} m at {} degrees, cut by two joint sets. The toe is the origin, x runs into the slope, y upwards. Look at it "
                  "with openclose cut "
                  "before you ask for the factor of safety with openclose fos.",
                  height, face));
  begin(text, fmt::format("A rock slope of {} m", height), 0.0);
  add_material(text, {"rock", 2600.0, 1e10, 2e9, 35.0, 25e3});
  text.blank_line();
  text.comment("The strength of one joint set alone, for the key joint below; the sets that name no joint keep the one above.");
  text.left_out_table("joint");
  text.left_out_key("name", std::string_view("bedding"));
  text.left_out_key("normal_stiffness_pa_per_m", 1e10);
  text.left_out_key("shear_stiffness_pa_per_m", 2e9);
  text.left_out_key("friction_angle_deg", 28.0);
  text.left_out_key("cohesion_pa", 0.0);
  text.blank_line();
  text.comment("Rock between joints of finite length, for the key bridge below: the strength of rock, which is lost once it has slipped.");
  text.left_out_table("joint");
  text.left_out_key("name", std::string_view("rock bridge"));
  text.left_out_key("normal_stiffness_pa_per_m", 1e10);
  text.left_out_key("shear_stiffness_pa_per_m", 5e9);
  text.left_out_key("friction_angle_deg", 45.0);
  text.left_out_key("cohesion_pa", 1e6);
  text.left_out_key("tensile_strength_pa", 5e5);
  text.left_out_key("cohesion_behaviour", std::string_view("lost_on_slip"));
  text.left_out_key("residual_friction_angle_deg", 35.0);
  text.left_out_key("slip_weakening_distance_m", 0.005);
  text.table("domain", "From the lower left corner: the ground below, the back, the crest, the toe, the bench before it");
  text.key("material", std::string_view("rock"));
  text.points("vertices_m", {{left, bottom}, {right, bottom}, {right, height}, {crest, height}, {0.0, 0.0}, {left, 0.0}});
  add_joint_set(text, "The first set, the bedding: a positive dip comes out of the face, and a joint of it ends in the toe", d.of("bedding_dip_deg"),
                d.of("bedding_spacing_m"));
  text.left_out_key("joint", std::string_view("bedding"));
  add_joint_set(text, "The second set, the cross joints: a negative dip goes into the slope", d.of("cross_dip_deg"), d.of("cross_spacing_m"));
  text.left_out_key("trace_length_m", 12.0);
  text.left_out_key("gap_m", 2.0);
  text.left_out_key("bridge", std::string_view("rock bridge"));
  add_fixed_line(text, {left, bottom}, {right, bottom});
  add_fixed_line(text, {right, bottom}, {right, height});
  add_fixed_line(text, {left, bottom}, {left, 0.0});
  add_motion(text, 5e-3, 2.0);
  return text.text();
}

}  // namespace

Draft slope_draft() {
  constexpr Range turn{.low = -90.0, .high = 90.0, .low_included = true, .high_included = true};
  return {"slope",
          "a rock slope with two joint sets",
          {{"height_m", "from toe to crest", 40.0},
           {"face_angle_deg", "of the face above the horizontal", 60.0, {.low = 0.0, .high = 90.0, .high_included = true}},
           {"bench_m", "of level ground before the toe", 20.0},
           {"depth_m", "of rock below the toe", 15.0},
           {"behind_m", "of level ground behind the crest", 60.0},
           {"bedding_dip_deg", "of the first joint set; positive: out of the face", 30.0, turn},
           {"bedding_spacing_m", "of the first joint set, at right angles to it", 6.0},
           {"cross_dip_deg", "of the second joint set; negative: into the slope", -70.0, turn},
           {"cross_spacing_m", "of the second joint set, at right angles to it", 8.0}},
          &write_slope};
}

}  // namespace openclose
