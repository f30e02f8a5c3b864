#include "openclose/scene/base_motion.h"

#include <fmt/format.h>

#include <filesystem>

#include "openclose/scene/angle.h"
#include "openclose/scene/names.h"

namespace openclose {
namespace {

std::vector<BasePulse> read_pulses(Table& table) {
  std::vector<BasePulse> pulses;
  const std::vector<Table> tables = table.tables("pulse");
  table.finish();
  if (tables.empty()) table.fail("there are no pulses", "at least one [[base_motion.pulse]]");
  for (Table pulse_table : tables) {
    BasePulse pulse;
    pulse_table.optional("start_s", pulse.start, not_negative);
    pulse_table.required("duration_s", pulse.duration, positive);
    pulse_table.required("acceleration_m_per_s2", pulse.acceleration);
    pulse_table.finish();
    pulses.push_back(pulse);
  }
  return pulses;
}

/// One direction: a file, or its numbers in the scene.
class RecordKeys {
 public:
  RecordKeys(Table& table, const std::string& direction)
      : table_(table), file_key_(direction + "_file"), times_key_(direction + "_time_s"), values_key_(direction + "_m_per_s2") {
    has_file_ = table.optional(file_key_, file_);
    has_times_ = table.optional(times_key_, numbers_.times, not_negative);
    has_values_ = table.optional(values_key_, numbers_.accelerations);
  }

  bool given() const { return has_file_ || has_times_ || has_values_; }

  /// To be called after Table::finish().
  /// \param files  to which the file is added from which it is read
  AccelerationRecord record(const std::string& folder, std::vector<std::string>& files) const {
    if (has_file_ && (has_times_ || has_values_)) table_.at(file_key_).fail("file and numbers are both given", "one of the two");
    if (has_file_) return read_acceleration_record(files.emplace_back((std::filesystem::path(folder) / file_).string()));
    if (has_times_ != has_values_) table_.fail(fmt::format("only one of {} and {} is given", times_key_, values_key_), "both of them");
    if (!given()) return {};
    const std::vector<double>& times = numbers_.times;
    if (times.size() < 2) table_.at(times_key_).fail(fmt::format("there are {} times", times.size()), "at least 2 times");
    if (times.size() != numbers_.accelerations.size())
      table_.at(values_key_)
          .fail(fmt::format("there are {} values", numbers_.accelerations.size()), fmt::format("{}, as many as times", times.size()));
    for (std::size_t i = 1; i < times.size(); ++i) {
      if (times[i] < times[i - 1])
        table_.at(times_key_).element(i).fail(fmt::format("{} follows {}", times[i], times[i - 1]), "times that do not decrease");
    }
    return numbers_;
  }

 private:
  Table& table_;
  std::string file_key_, times_key_, values_key_, file_;
  AccelerationRecord numbers_;
  bool has_file_ = false, has_times_ = false, has_values_ = false;
};

void read_harmonic(Table& table, BaseMotionInput& motion) {
  double phase_deg = 0.0;
  table.required("amplitude_m_per_s2", motion.amplitude);
  table.required("frequency_hz", motion.frequency, positive);
  table.optional("phase_deg", phase_deg);
  table.finish();
  motion.phase = radians(phase_deg);
}

void read_record(Table& table, const std::string& scene_file, BaseMotionInput& motion) {
  const RecordKeys horizontal(table, "horizontal"), vertical(table, "vertical");
  table.finish();
  if (!horizontal.given() && !vertical.given()) table.fail("there is no record", "horizontal_file, vertical_file or both");
  const std::string folder = std::filesystem::path(scene_file).parent_path().string();
  motion.horizontal = horizontal.record(folder, motion.files);
  motion.vertical = vertical.record(folder, motion.files);
}

}  // namespace

BaseMotionInput read_base_motion(Table table, const std::string& scene_file) {
  BaseMotionInput motion;
  // What else is accepted depends on the kind.
  if (!table.optional("kind", motion.kind, base_motion_words)) table.fail("kind is missing", "kind = \"pulses\", \"harmonic\" or \"record\"");
  table.optional("factor", motion.factor);
  switch (motion.kind) {
    case BaseMotionKind::pulses:
      motion.pulses = read_pulses(table);
      break;
    case BaseMotionKind::harmonic:
      read_harmonic(table, motion);
      break;
    case BaseMotionKind::record:
      read_record(table, scene_file, motion);
      break;
  }
  return motion;
}

}  // namespace openclose
