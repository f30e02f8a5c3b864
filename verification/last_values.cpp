#include "last_values.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace openclose::verification {
namespace {

constexpr const char* header = "case,quantity,method,value,relative_tolerance";

/// The fields of a line; those with commas stand in quotes.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool in_quotes = false;
  for (const char c : line) {
    if (c == '"') {
      in_quotes = !in_quotes;
    } else if (c == ',' && !in_quotes) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

const Check* find(const std::vector<Check>& checks, const LastValue& value) {
  const auto it = std::find_if(checks.begin(), checks.end(), [&](const Check& c) {
    return c.case_name == value.case_name && c.quantity == value.quantity && c.method == value.method;
  });
  return it == checks.end() ? nullptr : &*it;
}

}  // namespace

std::vector<LastValue> read_last_values(const std::string& path) {
  std::ifstream file(path);
  std::vector<LastValue> values;
  std::string line;
  if (!std::getline(file, line) || line != header) throw std::runtime_error(path + " must begin with " + header);
  for (int number = 2; std::getline(file, line); ++number) {
    const auto fields = fields_of(line);
    try {
      if (fields.size() != 5) throw std::invalid_argument("fields");
      values.push_back({fields[0], fields[1], fields[2], std::stod(fields[3]), std::stod(fields[4])});
    } catch (const std::logic_error&) {
      throw std::runtime_error(fmt::format("{}:{}: expected {}", path, number, header));
    }
  }
  return values;
}

void write_last_values(const std::string& path, const std::vector<LastValue>& values) {
  std::ofstream file(path);
  fmt::print(file, "{}\n", header);
  for (const LastValue& v : values) fmt::print(file, "{},\"{}\",{},{:.12g},{:g}\n", v.case_name, v.quantity, v.method, v.value, v.relative_tolerance);
  if (!file) throw std::runtime_error("cannot write " + path);
}

int renew(std::vector<LastValue>& values, const std::vector<Check>& checks) {
  int renewed = 0;
  for (LastValue& v : values) {
    const Check* check = find(checks, v);
    if (!check || check->measured == v.value) continue;
    v.value = check->measured;
    ++renewed;
  }
  return renewed;
}

void compare(Report& report, const std::vector<LastValue>& values) {
  const std::vector<Check> checks = report.checks();
  for (const LastValue& v : values) {
    if (std::none_of(checks.begin(), checks.end(), [&](const Check& c) { return c.case_name == v.case_name; })) continue;
    const Check* check = find(checks, v);
    report.begin_case(v.case_name);
    report.against(Reference::last_value)
        .relative("last value: " + v.quantity, v.method, v.value, check ? check->measured : not_measured(), v.relative_tolerance,
                  check ? check->unit : "", check ? "verification/last_values.csv" : "verification/last_values.csv names a row that is not there");
  }
}

}  // namespace openclose::verification
