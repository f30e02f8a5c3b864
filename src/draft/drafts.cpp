#include "openclose/draft/drafts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "openclose/core/error.h"
#include "openclose/draft/all_drafts.h"
#include "openclose/scene/check.h"
#include "openclose/scene/reader.h"

namespace openclose {
namespace {

void require_valid(const Draft& draft, const std::string& name, double value) {
  const SourceLocation where{"new " + std::string(draft.name), 0};
  const auto dimension = std::ranges::find(draft.dimensions, std::string_view(name), &Dimension::name);
  if (dimension == draft.dimensions.end()) {
    std::string names;
    for (const Dimension& known : draft.dimensions) names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
    throw InputError(where, name, "it has no such dimension", names);
  }
  if (dimension->range.contains(value) && (!dimension->is_whole || value == std::floor(value))) return;
  throw InputError(where, name, fmt::format("{} is out of range", value), dimension->range.describe(dimension->is_whole ? "whole number" : "number"));
}

}  // namespace

const std::vector<Draft>& drafts() {
  static const std::vector<Draft> all{arch_draft(), slope_draft(), wall_draft()};
  return all;
}

std::string scene_from(const Draft& draft, const std::map<std::string, double>& asked) {
  for (const auto& [name, value] : asked) require_valid(draft, name, value);
  const std::string text = draft.write(Dimensions(draft.dimensions, asked));
  try {
    check_scene(scene_of_text(text, "new"));
  } catch (const InputError& error) {
    throw InputError({"new " + std::string(draft.name), 0}, "", fmt::format("these dimensions make no scene together ({})", error.what()),
                     "the default ones, or others nearer to them");
  }
  return text;
}

}  // namespace openclose
