#include "openclose/scene/nearest.h"
#include "support/catch.h"

using namespace openclose;

TEST_CASE("the unit at the end of a key is recognised", "[scene][nearest]") {
  CHECK(without_unit("density_kg_per_m3") == "density");
  CHECK(without_unit("density_g_per_cm3") == "density");
  CHECK(without_unit("normal_stiffness_mpa_per_mm") == "normal_stiffness");
  CHECK(without_unit("friction_angle_rad") == "friction_angle");
  CHECK(without_unit("gravity_m_per_s2") == "gravity");
  CHECK(without_unit("max_steps") == "max_steps");
  CHECK(without_unit("name") == "name");
  CHECK(without_unit("m") == "m");
}

TEST_CASE("the same quantity in another unit", "[scene][nearest]") {
  const std::vector<std::string> accepted{"name", "density_kg_per_m3", "unit_weight_n_per_m3", "width"};
  CHECK(same_quantity("density_g_per_cm3", accepted) == std::vector<std::string>{"density_kg_per_m3"});
  CHECK(same_quantity("density", accepted) == std::vector<std::string>{"density_kg_per_m3"});
  CHECK(same_quantity("width_mm", accepted) == std::vector<std::string>{"width"});
  CHECK(same_quantity("weight", accepted).empty());
}

TEST_CASE("suggestions begin with the most alike and do not grow without bound", "[scene][nearest]") {
  CHECK(suggestions("fixd", {"name", "vertices_m", "fixed"}) == "fixed, name, vertices_m");
  CHECK(suggestions("friktion", {"fraction", "function_of_time", "joint.friction_angle_deg"}) ==
        "fraction, joint.friction_angle_deg, function_of_time");
  std::vector<std::string> many;
  for (int i = 0; i < 1000; ++i) many.push_back("block" + std::to_string(i));
  const std::string text = suggestions("block777x", many);
  CHECK(text.substr(0, 9) == "block777,");
  CHECK(text.size() < 200);
  CHECK(text.find("(1000 in all)") != std::string::npos);
}

TEST_CASE("exchanged letters and short words are understood", "[scene][nearest]") {
  const std::vector<std::string> words{"run", "fos", "check", "draw", "hard", "dem"};
  CHECK(similar("fso", words) == "fos");
  CHECK(similar("darw", words) == "draw");
  CHECK(similar("hrad", words) == "hard");
  CHECK(similar("chekc", words) == "check");
  CHECK(similar("den", words) == "dem");
  CHECK_FALSE(similar("xyz", words));
  CHECK_FALSE(similar("dxm", {"me"}));
  CHECK_FALSE(similar("hwdr", words));
  CHECK(did_you_mean("fso", words) == ", did you mean fos?");
  CHECK(did_you_mean("xyz", words).empty());
}
