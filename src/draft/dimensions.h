// The numbers that shape a draft, as the command line may give them.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "openclose/scene/limits.h"

namespace openclose {

struct Dimension {
  std::string_view name;  ///< its unit stands at the end, as in the keys of a scene
  std::string_view says;
  double value = 0.0;  ///< unless another one is asked for
  Range range = positive;
  bool is_whole = false;
};

/// Values by name, in the units of the names.
class Dimensions {
 public:
  /// What is asked for has been checked.
  Dimensions(const std::vector<Dimension>& all, const std::map<std::string, double>& asked) {
    for (const Dimension& dimension : all) values_.emplace(dimension.name, dimension.value);
    for (const auto& [name, value] : asked) values_[name] = value;
  }

  double of(const std::string& name) const { return values_.at(name); }
  int count(const std::string& name) const { return static_cast<int>(values_.at(name)); }

 private:
  std::map<std::string, double> values_;
};

}  // namespace openclose
