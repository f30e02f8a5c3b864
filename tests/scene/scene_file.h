// Scene files made for a test.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "openclose/core/error.h"
#include "openclose/scene/reader.h"

namespace openclose::test {

/// A file that lives as long as the object.
class SceneFile {
 public:
  explicit SceneFile(const std::string& text) : path_(unique_path()) { std::ofstream(path_, std::ios::binary) << text; }
  ~SceneFile() { std::filesystem::remove(path_); }
  SceneFile(const SceneFile&) = delete;
  SceneFile& operator=(const SceneFile&) = delete;

  std::string path() const { return path_.string(); }

 private:
  /// The time tells apart test programs that run side by side, the count the files of one of them.
  static std::filesystem::path unique_path() {
    static int count = 0;
    static const auto run = std::filesystem::file_time_type::clock::now().time_since_epoch().count();
    return std::filesystem::temp_directory_path() / ("openclose_scene_" + std::to_string(run) + "_" + std::to_string(++count) + ".toml");
  }

  std::filesystem::path path_;
};

inline Scene read_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return read_scene(SceneFile(text).path(), overrides);
}

/// A block on a base, everything optional left out. Lines are counted from 1.
inline const std::string block_on_base =
    "[[material]]\n"                                       // 1
    "name = \"rock\"\n"                                    // 2
    "density_kg_per_m3 = 2700\n"                           // 3
    "\n"                                                   // 4
    "[[joint]]\n"                                          // 5
    "materials = [\"rock\", \"rock\"]\n"                   // 6
    "normal_stiffness_pa_per_m = 1e9\n"                    // 7
    "shear_stiffness_pa_per_m = 4e8\n"                     // 8
    "friction_angle_deg = 35\n"                            // 9
    "\n"                                                   // 10
    "[[block]]\n"                                          // 11
    "name = \"base\"\n"                                    // 12
    "material = \"rock\"\n"                                // 13
    "vertices_m = [[-1, -1], [2, -1], [2, 0], [-1, 0]]\n"  // 14
    "fixed = true\n"                                       // 15
    "\n"                                                   // 16
    "[[block]]\n"                                          // 17
    "name = \"block\"\n"                                   // 18
    "material = \"rock\"\n"                                // 19
    "vertices_m = [[0, 0], [1, 0], [1, 1], [0, 1]]\n"      // 20
    "\n";                                                  // 21, what is appended begins on line 22

/// The text with one line (counted from 1) replaced; the new text may have several lines, or be empty.
inline std::string with_line(const std::string& text, int line, const std::string& replacement) {
  std::size_t begin = 0;
  for (int i = 1; i < line; ++i) begin = text.find('\n', begin) + 1;
  std::string changed = text;
  return changed.replace(begin, text.find('\n', begin) - begin, replacement);
}

}  // namespace openclose::test
