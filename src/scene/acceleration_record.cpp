#include "openclose/scene/acceleration_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "openclose/scene/table.h"

namespace openclose {
namespace {

constexpr const char* times_column = "time_s";
constexpr const char* accepted_header = "\"time_s,acceleration_m_per_s2\" or \"time_s,acceleration_g\"";
constexpr int at2_text_lines = 3;
/// More values than any record has; an announced number beyond it is a fault of the header.
constexpr double most_values = 1e8;

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::string trimmed(const std::string& text) {
  const char* blanks = " \t\r\f\v";
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The whole text as a finite number.
std::optional<double> number(const std::string& text) {
  const char* begin = text.data() + (text.size() > 1 && text.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The lines of a file, counted.
class Lines {
 public:
  Lines(std::istream& stream, const std::string& path) : stream_(stream), path_(path) {}
  bool next(std::string& line) {
    if (!std::getline(stream_, line)) return false;
    // The mark of UTF-8 with which some programs begin a text.
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (++count_ == 1 && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
    line = trimmed(line);
    return true;
  }
  [[noreturn]] void fail(const std::string& read, const std::string& accepted) const { throw_input_error({path_, count_}, "", read, accepted); }

 private:
  std::istream& stream_;
  std::string path_;
  int count_ = 0;
};

AccelerationRecord read_csv(Lines& lines) {
  AccelerationRecord record;
  double unit = 0.0;
  std::string line;
  while (lines.next(line)) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t comma = line.find(',');
    const std::string first = trimmed(line.substr(0, comma)), second = comma == std::string::npos ? "" : trimmed(line.substr(comma + 1));
    if (unit == 0.0) {
      if (first == times_column && second == "acceleration_m_per_s2") unit = 1.0;
      if (first == times_column && second == "acceleration_g") unit = standard_gravity;
      if (unit == 0.0) lines.fail(in_quotes(line) + " is no header of a record", accepted_header);
      continue;
    }
    const std::optional<double> time = number(first), acceleration = number(second);
    if (!time || !acceleration) lines.fail(in_quotes(line) + " is no row of a record", "two numbers, separated by a comma");
    if (*time < 0.0) lines.fail(fmt::format("the time {} is negative", *time), "times from 0 on");
    if (!record.times.empty() && *time < record.times.back())
      lines.fail(fmt::format("the time {} follows {}", *time, record.times.back()), "times that do not decrease");
    record.times.push_back(*time);
    record.accelerations.push_back(unit * *acceleration);
  }
  if (unit == 0.0) lines.fail("the file has no header", accepted_header);
  if (record.times.size() < 2) lines.fail(fmt::format("there are {} rows", record.times.size()), "at least 2 rows");
  return record;
}

struct At2Size {
  std::size_t count;
  double dt;  ///< [s]
};

/// Both ways in which the fourth line has been written: its two numbers, in the order of the words.
At2Size read_at2_size(const Lines& lines, const std::string& line) {
  const std::string capitals = in_capitals(line);
  std::string plain = capitals;
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return c == '=' || c == ','; }, ' ');
  std::vector<double> numbers;
  std::istringstream words(plain);
  for (std::string word; words >> word;) {
    if (const std::optional<double> value = number(word)) numbers.push_back(*value);
  }
  const bool named = capitals.find("NPTS") != std::string::npos && capitals.find("DT") != std::string::npos;
  if (!named || numbers.size() != 2)
    lines.fail(in_quotes(line) + " does not tell number and spacing of the values", "e.g. NPTS=  4000, DT=  .0050 SEC");
  if (numbers[0] < 2.0 || numbers[0] > most_values || numbers[0] != std::floor(numbers[0]))
    lines.fail(fmt::format("NPTS is {}", numbers[0]), "a whole number from 2 on");
  if (!(numbers[1] > 0.0)) lines.fail(fmt::format("DT is {}", numbers[1]), "a number of seconds > 0");
  return {static_cast<std::size_t>(numbers[0]), numbers[1]};
}

AccelerationRecord read_at2(Lines& lines) {
  std::string line, text;
  for (int i = 0; i < at2_text_lines; ++i) {
    if (!lines.next(line)) lines.fail("the file ends within its header", "four header lines, then the values");
    text += ' ' + in_capitals(line);
  }
  if (text.find("UNITS OF G") == std::string::npos) lines.fail("the header does not say \"UNITS OF G\"", "accelerations in units of g");
  if (!lines.next(line)) lines.fail("the file ends within its header", "four header lines, then the values");
  const At2Size size = read_at2_size(lines, line);

  AccelerationRecord record;
  while (lines.next(line)) {
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const std::optional<double> value = number(word);
      if (!value) lines.fail(in_quotes(word) + " is not a number", "accelerations in units of g");
      if (record.times.size() == size.count) lines.fail("there are more values than NPTS says", fmt::format("{} values", size.count));
      record.times.push_back(static_cast<double>(record.times.size()) * size.dt);
      record.accelerations.push_back(standard_gravity * *value);
    }
  }
  if (record.times.size() < size.count)
    lines.fail(fmt::format("the file ends after {} values", record.times.size()), fmt::format("{} values", size.count));
  return record;
}

/// Or AT2, by the ending of the name, which must be one of the two.
bool is_csv(const std::string& path) {
  const std::string ending = in_capitals(std::filesystem::path(path).extension().string());
  if (ending != ".CSV" && ending != ".AT2") throw_input_error({path, 0}, "", "the name ends in neither .csv nor .AT2", "NAME.csv or NAME.AT2");
  return ending == ".CSV";
}

}  // namespace

AccelerationRecord read_acceleration_record(const std::string& path) {
  is_csv(path);  // a name of neither kind is refused before the file is looked for
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw_input_error({path, 0}, "", "there is no such file", "the path of an acceleration record, from the folder of the scene");
  std::ifstream stream(path);
  return acceleration_record_in(stream, path);
}

AccelerationRecord acceleration_record_in(std::istream& stream, const std::string& path) {
  Lines lines(stream, path);
  return is_csv(path) ? read_csv(lines) : read_at2(lines);
}

}  // namespace openclose
