// Base motion and acceleration records: what is read, and each kind of fault.
#include <filesystem>
#include <fstream>

#include "openclose/scene/writer.h"
#include "scene_file.h"
#include "support/catch.h"

using namespace openclose;
using Catch::Matchers::ContainsSubstring;
using openclose::test::block_on_base;
using openclose::test::read_text;

namespace {

BaseMotionInput motion_of(const std::string& text) {
  return read_text(block_on_base + text).base_motion.value();
}

std::string error_of(const std::string& text) {
  try {
    read_text(block_on_base + text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// A record that lives as long as the object.
class RecordFile {
 public:
  RecordFile(const std::string& name, const std::string& text)
      : path_(std::filesystem::temp_directory_path() /
              ("openclose_" + std::to_string(std::filesystem::file_time_type::clock::now().time_since_epoch().count()) + name)) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~RecordFile() { std::filesystem::remove(path_); }
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

AccelerationRecord record_of(const std::string& name, const std::string& text) {
  return read_acceleration_record(RecordFile(name, text).path());
}

/// The error with the file's name cut off.
std::string record_error(const std::string& name, const std::string& text) {
  const RecordFile file(name, text);
  try {
    read_acceleration_record(file.path());
  } catch (const InputError& error) {
    const std::string message = error.what();
    REQUIRE(message.substr(0, file.path().size() + 1) == file.path() + ":");
    return message.substr(file.path().size() + 1);
  }
  return "no error";
}

const std::string at2_header =
    "PEER NGA STRONG MOTION DATABASE RECORD\r\nNowhere, 1/1/2000, Station 1, 90\r\nACCELERATION TIME SERIES IN UNITS OF G\r\n";

}  // namespace

TEST_CASE("a scene without base motion has none", "[scene][base_motion]") {
  CHECK(!read_text(block_on_base).base_motion);
}

TEST_CASE("kinds of base motion", "[scene][base_motion]") {
  SECTION("pulses") {
    const auto m = motion_of(
        "[base_motion]\nkind = 'pulses'\nfactor = -2\n[[base_motion.pulse]]\nduration_s = 0.5\nacceleration_m_per_s2 = [3, 1]\n"
        "[[base_motion.pulse]]\nstart_s = 1\nduration_s = 0.25\nacceleration_m_per_s2 = [-3, 0]\n");
    CHECK(m.factor == -2.0);
    REQUIRE(m.pulses.size() == 2);
    CHECK(m.pulses[0].start == 0.0);
    CHECK(m.pulses[0].duration == 0.5);
    CHECK(m.pulses[0].acceleration == Vec2(3.0, 1.0));
    CHECK(m.pulses[1].start == 1.0);
  }
  SECTION("harmonic") {
    const auto m = motion_of("[base_motion]\nkind = 'harmonic'\namplitude_m_per_s2 = [2.943, 0]\nfrequency_hz = 2\nphase_deg = 90\n");
    CHECK(m.factor == 1.0);
    CHECK(m.amplitude == Vec2(2.943, 0.0));
    CHECK(m.frequency == 2.0);
    CHECK(m.phase == Approx(1.5707963267948966));
  }
  SECTION("record in the scene") {
    const auto m = motion_of("[base_motion]\nkind = 'record'\nvertical_time_s = [0, 1, 1]\nvertical_m_per_s2 = [0, 2, -2]\n");
    CHECK(m.horizontal.times.empty());
    CHECK(m.vertical == AccelerationRecord{{0.0, 1.0, 1.0}, {0.0, 2.0, -2.0}});
  }
  SECTION("record from a file beside the scene") {
    const RecordFile file("beside.csv", "time_s,acceleration_m_per_s2\n0,1\n1,2\n");
    const auto m = motion_of("[base_motion]\nkind = 'record'\nhorizontal_file = '" + std::filesystem::path(file.path()).filename().string() + "'\n");
    CHECK(m.horizontal == AccelerationRecord{{0.0, 1.0}, {1.0, 2.0}});
  }
}

TEST_CASE("base motion survives writing and reading", "[scene][base_motion][writer]") {
  for (const std::string text : {"kind = 'pulses'\n[[base_motion.pulse]]\nstart_s = 0.1\nduration_s = 0.7\nacceleration_m_per_s2 = [3.1, -1]\n",
                                 "kind = 'harmonic'\nfactor = 0.3\namplitude_m_per_s2 = [2.943, 1]\nfrequency_hz = 2.1\nphase_deg = 33\n",
                                 "kind = 'record'\nhorizontal_time_s = [0, 0.1]\nhorizontal_m_per_s2 = [0.1, 2]\nvertical_time_s = [0.3, 1, "
                                 "1]\nvertical_m_per_s2 = [0, 2, -2]\n"}) {
    INFO(text);
    const Scene scene = read_text(block_on_base + "[base_motion]\n" + text);
    const auto a = *scene.base_motion, b = read_text(write_scene(scene)).base_motion.value();
    CHECK(a.kind == b.kind);
    CHECK(a.factor == b.factor);
    REQUIRE(a.pulses.size() == b.pulses.size());
    for (std::size_t i = 0; i < a.pulses.size(); ++i) {
      CHECK(a.pulses[i].start == b.pulses[i].start);
      CHECK(a.pulses[i].duration == b.pulses[i].duration);
      CHECK(a.pulses[i].acceleration == b.pulses[i].acceleration);
    }
    CHECK(a.amplitude == b.amplitude);
    CHECK(a.frequency == b.frequency);
    CHECK(a.phase == b.phase);
    CHECK(a.horizontal == b.horizontal);
    CHECK(a.vertical == b.vertical);
  }
}

TEST_CASE("faults of base motion", "[scene][base_motion][errors]") {
  CHECK_THAT(error_of("[base_motion]\n"), ContainsSubstring("22: base_motion: kind is missing"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'pulse'\n"), ContainsSubstring("23: base_motion.kind: \"pulse\" is not known; accepted: \"pulses\""));
  CHECK_THAT(error_of("[base_motion]\nkind = 'pulses'\n"), ContainsSubstring("22: base_motion: there are no pulses"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'pulses'\nfrequency_hz = 1\n"),
             ContainsSubstring("24: base_motion.frequency_hz: this key is not known"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'pulses'\n[[base_motion.pulse]]\nduration_s = 0\n"),
             ContainsSubstring("25: base_motion.pulse[0].duration_s: 0"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'harmonic'\namplitude_m_per_s2 = [1, 0]\n"), ContainsSubstring("frequency_hz"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\n"), ContainsSubstring("22: base_motion: there is no record"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_file = 'nowhere.csv'\n"), ContainsSubstring("nowhere.csv: there is no such file"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_file = 'a.txt'\n"), ContainsSubstring("ends in neither .csv nor .AT2"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_time_s = [0, 1]\n"), ContainsSubstring("only one of horizontal_time_s"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_time_s = [0, 1]\nhorizontal_m_per_s2 = [0]\n"),
             ContainsSubstring("there are 1 values"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_time_s = [1, 0]\nhorizontal_m_per_s2 = [0, 1]\n"),
             ContainsSubstring("0 follows 1"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_time_s = [0]\nhorizontal_m_per_s2 = [0]\n"),
             ContainsSubstring("there are 1 times"));
  CHECK_THAT(error_of("[base_motion]\nkind = 'record'\nhorizontal_file = 'a.csv'\nhorizontal_time_s = [0]\nhorizontal_m_per_s2 = [0]\n"),
             ContainsSubstring("file and numbers are both given"));
  CHECK_THAT(error_of("[method]\nstatics = true\n[base_motion]\nkind = 'harmonic'\namplitude_m_per_s2 = [1, 0]\nfrequency_hz = 1\n"),
             ContainsSubstring("24: base_motion: steps that start from rest"));
}

TEST_CASE("records as CSV", "[scene][record]") {
  CHECK(record_of("a.csv", "# made by hand\ntime_s,acceleration_m_per_s2\n0,1.5\n\n 0.5 , -2e-1\r\n0.5,+3\n") ==
        AccelerationRecord{{0.0, 0.5, 0.5}, {1.5, -0.2, 3.0}});
  CHECK(record_of("a.CSV", "time_s,acceleration_g\n0,1\n1,0").accelerations.front() == standard_gravity);
  CHECK(record_of("a.csv", "\xEF\xBB\xBFtime_s,acceleration_g\r\n0,1\r\n1,0").accelerations.front() == standard_gravity);
  CHECK_THAT(record_error("a.csv", "t,a\n0,1\n"),
             ContainsSubstring("1: \"t,a\" is no header of a record; accepted: \"time_s,acceleration_m_per_s2\""));
  CHECK_THAT(record_error("a.csv", ""), ContainsSubstring("has no header"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n0,1\n0.1,x\n"), ContainsSubstring("3: \"0.1,x\" is no row of a record"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n0,1\n0.1,nan\n"), ContainsSubstring("is no row of a record"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n0,1\n0.1,1,2\n"), ContainsSubstring("is no row of a record"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n0,1\n0.1,1\n0.05,1\n"), ContainsSubstring("4: the time 0.05 follows 0.1"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n-1,1\n"), ContainsSubstring("2: the time -1 is negative"));
  CHECK_THAT(record_error("a.csv", "time_s,acceleration_g\n0,1\n"), ContainsSubstring("there are 1 rows"));
}

TEST_CASE("records of the PEER database", "[scene][record]") {
  const double g = standard_gravity;
  for (const std::string size : {"NPTS=   5, DT=   .0200 SEC,\r\n", "5   0.0200   NPTS, DT\n"}) {
    const AccelerationRecord r = record_of("a.AT2", at2_header + size + "  .1000000E-01  -.2000000E-01   .0000000E+00\n   .5000000E+00\r\n -1.25\n");
    CHECK(r.times == std::vector<double>{0.0, 0.02, 2 * 0.02, 3 * 0.02, 4 * 0.02});
    CHECK(r.accelerations == std::vector<double>{g * 0.01, g * -0.02, 0.0, g * 0.5, g * -1.25});
  }
  CHECK_THAT(record_error("a.at2", "one\ntwo\n"), ContainsSubstring("2: the file ends within its header"));
  CHECK_THAT(record_error("a.at2", at2_header), ContainsSubstring("3: the file ends within its header"));
  CHECK_THAT(record_error("a.at2", "one\ntwo\nACCELERATION IN CM/S2\n3 0.1 NPTS, DT\n"), ContainsSubstring("does not say \"UNITS OF G\""));
  CHECK_THAT(record_error("a.at2", at2_header + "3 0.1\n"), ContainsSubstring("4: \"3 0.1\" does not tell number and spacing"));
  CHECK_THAT(record_error("a.at2", at2_header + "NPTS= 2.5, DT= 0.1\n"), ContainsSubstring("4: NPTS is 2.5"));
  CHECK_THAT(record_error("a.at2", at2_header + "NPTS= 2, DT= 0\n"), ContainsSubstring("4: DT is 0"));
  CHECK_THAT(record_error("a.at2", at2_header + "NPTS= 2, DT= 0.1\n1 2 3\n"),
             ContainsSubstring("5: there are more values than NPTS says; accepted: 2 values"));
  CHECK_THAT(record_error("a.at2", at2_header + "NPTS= 4, DT= 0.1\n1 2 3\n"), ContainsSubstring("the file ends after 3 values; accepted: 4 values"));
  CHECK_THAT(record_error("a.at2", at2_header + "NPTS= 2, DT= 0.1\n1 E\n"), ContainsSubstring("5: \"E\" is not a number"));
}
