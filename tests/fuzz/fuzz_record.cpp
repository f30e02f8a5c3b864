// The readers of acceleration records: the first byte says which of the two, the others are the file.
#include <cmath>
#include <sstream>
#include <string>

#include "harness.h"
#include "openclose/core/error.h"
#include "openclose/scene/acceleration_record.h"

using namespace openclose;

namespace {

void read(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  const AccelerationRecord record = acceleration_record_in(stream, name);
  require_promise(record.times.size() == record.accelerations.size() && record.times.size() >= 2, "as many accelerations as times, and two at least");
  for (std::size_t i = 0; i < record.times.size(); ++i) {
    require_promise(std::isfinite(record.times[i]) && std::isfinite(record.accelerations[i]), "numbers are finite");
    require_promise(i == 0 || record.times[i] >= record.times[i - 1], "times do not decrease");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    read(std::string(reinterpret_cast<const char*>(data + 1), size - 1), data[0] % 2 == 0 ? "record.csv" : "record.AT2");
  } catch (const InputError& error) {
    require_promise(std::string(error.what()).find('\n') == std::string::npos, "a message is one line");
  }
  return 0;
}
