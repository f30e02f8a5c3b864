#include "openclose/io/checkpoint.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/core/tolerance.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/keys.h"
#include "openclose/scene/writer.h"
#include "openclose/version.h"

namespace openclose {
namespace {

/// To be raised with every change of what any exchange() hands over.
constexpr int format = 49;
/// Reads differently where the order of bytes is another one.
constexpr std::uint32_t byte_order = 0x01020304;

std::string heading() {
  return fmt::format("openclose checkpoint, format {}, version {}\n", format, version);
}

std::string changeable_keys() {
  std::string keys;
  for (const KeyEntry& entry : key_entries(Scene{})) {
    if (entry.key.may_change_on_restart) keys += (keys.empty() ? "" : ", ") + entry.dotted();
  }
  return keys;
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& accepted) {
  throw InputError({path, 0}, "", what, accepted);
}

std::string read_bytes(const std::string& path) {
  const std::string accepted = "the path of a checkpoint.bin that a run or fos that was broken off has left";
  std::error_code error;
  if (!std::filesystem::exists(path, error)) refuse(path, "there is no such file", accepted);
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "this is not a regular file", accepted);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) refuse(path, "the file cannot be read", accepted);
  return bytes;
}

/// What stands between the heading and the check sum.
std::string body_of(const std::string& bytes, const std::string& path) {
  const std::string expected = heading(), found = bytes.substr(0, bytes.find('\n') + 1);
  if (found != expected) {
    const bool other = found.rfind("openclose checkpoint, ", 0) == 0;
    refuse(path, other ? "it was written by another version: " + found.substr(0, found.size() - 1) : "this is no checkpoint",
           expected.substr(0, expected.size() - 1));
  }
  std::uint64_t sum = 0;
  const bool whole = bytes.size() >= expected.size() + sizeof sum;
  if (whole) std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
  if (!whole || sum != check_sum(std::string_view(bytes).substr(0, bytes.size() - sizeof sum)))
    refuse(path, "the checkpoint is damaged", "a whole one");
  return bytes.substr(expected.size(), bytes.size() - expected.size() - sizeof sum);
}

/// Names the first line in which the scenes differ.
void require_same_scene(const std::string& path, const std::string& saved, const Scene& scene) {
  const std::string given = write_fixed_part(scene);
  if (saved == given) return;
  std::istringstream a(saved), b(given);
  std::string in_saved, in_given;
  do {
    in_saved.clear();
    in_given.clear();
    std::getline(a, in_saved);
    std::getline(b, in_given);
  } while (in_saved == in_given && (a || b));
  refuse(path, fmt::format("it belongs to another scene: there \"{}\", here \"{}\"", in_saved, in_given),
         "the same scene, other in no more than " + changeable_keys());
}

void require_tables(const std::string& path, const Checkpoint& checkpoint) {
  for (const TableMark& mark : checkpoint.tables) {
    if (mark.name.empty() || std::filesystem::path(mark.name).filename() != mark.name)
      refuse(path, "it names a table that is none of a run", "a checkpoint as a run has written it");
    const std::string table = table_beside(path, mark.name), accepted = "the tables of the run, beside its checkpoint";
    std::error_code error;
    const std::uintmax_t there = std::filesystem::file_size(table, error);
    if (error || there < mark.length) refuse(table, fmt::format("the run goes on behind the first {} bytes of this table", mark.length), accepted);
    std::ifstream stream(table, std::ios::binary);
    std::string head(static_cast<std::size_t>(mark.length), ' ');
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    if (check_sum(head) != mark.sum)
      refuse(table, fmt::format("the first {} bytes of this table are not those that the run has written", mark.length), accepted);
  }
}

}  // namespace

std::string checkpoint_bytes(const Scene& scene, Checkpoint checkpoint) {
  Archive body;
  std::uint32_t order = byte_order;
  std::string text = write_fixed_part(scene);
  body(order, text, checkpoint);
  // A state may be as large as all else that a run has in memory: it is moved on instead of copied.
  std::string().swap(checkpoint.state);
  std::string bytes = body.take();
  bytes.insert(0, heading());
  append_check_sum(bytes);
  return bytes;
}

void append_check_sum(std::string& bytes) {
  const std::uint64_t sum = check_sum(bytes);
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof sum);
}

namespace {

/// The run has begun: what is there now and is no checkpoint of ours has come since.
void require_own_place(const std::string& path, const std::vector<TextFile>& files) {
  try {
    require_replaceable(files);
  } catch (const InputError&) {
    throw WriteError(
        path, "has been replaced since the analysis began by something that is no checkpoint of openclose: that stays, and no new one is written");
  }
}

}  // namespace

void write_checkpoint(const std::string& path, const Scene& scene, Checkpoint checkpoint) {
  const std::filesystem::path folder = absolute_path(path).parent_path();
  const auto require_folder = [&] {
    if (!is_folder(folder.string())) throw WriteError(path, "its folder has been removed while the run went on");
  };
  require_folder();
  std::vector<TextFile> files(1);
  files.front() = {path, checkpoint_bytes(scene, std::move(checkpoint))};
  require_own_place(path, files);
  try {
    write_files(files);
  } catch (const std::runtime_error&) {
    require_folder();
    throw WriteError(path);  // the run has begun: its input was good
  }
}

Checkpoint read_checkpoint(const std::string& path, const Scene& scene, const std::string& command) {
  Checkpoint checkpoint = checkpoint_of_bytes(read_bytes(path), path, scene);
  if (checkpoint.command != command)
    refuse(path, fmt::format("it was written by openclose {}", checkpoint.command), fmt::format("a checkpoint of openclose {}", command));
  return checkpoint;
}

Checkpoint checkpoint_of_bytes(const std::string& bytes, const std::string& path, const Scene& scene) {
  Archive body(body_of(bytes, path));
  std::uint32_t order = 0;
  std::string text;
  Checkpoint checkpoint;
  try {
    body(order);
    if (order != byte_order) refuse(path, "it was written by a processor with another order of bytes", "a checkpoint of this machine");
    body(text, checkpoint);
  } catch (const DamagedState& damage) {
    refuse(path, damage.what(), "a checkpoint as a run has written it");
  }
  require_same_scene(path, text, scene);
  if (scene.end_time * (1.0 + tolerance::rounding_of_times) < checkpoint.time)
    throw InputError(scene.where, "end.time_s",
                     fmt::format("{:g} s lies before the checkpoint, which stands at {:g} s", scene.end_time, checkpoint.time), "a later time");
  require_tables(path, checkpoint);
  return checkpoint;
}

std::string table_beside(const std::string& checkpoint_path, const std::string& table) {
  return (std::filesystem::path(checkpoint_path).parent_path() / table).string();
}

}  // namespace openclose
