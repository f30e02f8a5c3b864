#include "openclose/study/cases.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <set>
#include <thread>

#include "openclose/core/check_sum.h"
#include "openclose/core/error.h"
#include "openclose/core/files.h"
#include "openclose/io/folder_lock.h"
#include "openclose/io/output_folder.h"
#include "openclose/io/part_files.h"
#include "openclose/io/text_files.h"
#include "openclose/scene/check.h"
#include "openclose/scene/override.h"
#include "openclose/scene/reader.h"
#include "openclose/scene/writer.h"
#include "openclose/version.h"

extern char** environ;

namespace openclose {
namespace {

/// Stands in the folder of a case that has come to its end, whatever that was.
constexpr const char* mark_name = "case.txt";
constexpr const char* mark_start = "openclose ";

/// Between two looks at the processes: far below what it takes to start one.
constexpr std::chrono::milliseconds pause{2};

/// A file without a name, which goes with the last who has it open: what a case says of itself stands in nobody's way.
using NamelessFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

NamelessFile nameless_file() {
  NamelessFile file(std::tmpfile(), &std::fclose);
  if (!file || fcntl(fileno(file.get()), F_SETFD, FD_CLOEXEC) != 0) throw WriteError(P_tmpdir, "no file can be made here");
  return file;
}

std::string text_of(std::FILE* file) {
  std::rewind(file);
  std::string text;
  std::array<char, 4096> part;
  while (const std::size_t count = std::fread(part.data(), 1, part.size(), file)) text.append(part.data(), count);
  return text;
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return "";
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

/// A case on its way.
struct Running {
  std::size_t number;
  NamelessFile errors;  ///< what it writes to standard error
};

class Runner {
 public:
  Runner(const CaseOrder& order, const std::vector<Case>& cases, const std::function<void(std::size_t, const CaseResult&)>& done)
      : order_(order), cases_(cases), done_(done), results_(cases.size()) {
    // Whoever has started this program may have left it a disregard for the ends of its children, for which it is to wait.
    std::signal(SIGCHLD, SIG_DFL);
  }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;
  ~Runner() { stop_running(); }

  std::vector<CaseResult> run() {
    try {
      check_all();
      std::error_code error;
      std::filesystem::create_directories(order_.folder, error);
      if (error || access(order_.folder.c_str(), W_OK | X_OK) != 0)
        throw InputError({order_.folder, 0}, "", "cannot write to this folder", "-o with a folder that exists or can be made, and may be written to");
      const FolderLock lock(order_.folder);
      run_all();
    } catch (const Stopped&) {
      stop_running();
      throw Stopped(fmt::format("stopped when {} of {} cases had ended; the same command goes on with the others", ended_, cases_.size()));
    }
    return std::move(results_);
  }

 private:
  /// The mark of a case is replaced where it is openclose's own, be it without its end.
  static void require_our_mark(const std::string& path) {
    static const std::regex mark(fmt::format("{}[^ \\n]+ [a-z]+ [0-9a-f]{{16}}\\n[0-9]*\\n?", mark_start));
    if (is_there(path) && !std::regex_match(content_of(path), mark))
      throw InputError({path, 0}, "", "has not been written by openclose", "another folder, or that file under another name");
  }

  /// Of the same case; none if it is not there with all that is read of it.
  std::optional<int> status_of_earlier(std::size_t i) const {
    const std::string mark = content_of(path_of(i, mark_name));
    if (!mark.starts_with(marks_[i])) return std::nullopt;
    int status = 0;
    if (std::from_chars(mark.data() + marks_[i].size(), mark.data() + mark.size(), status).ec != std::errc()) return std::nullopt;
    const bool has_summary = status == exit_success || status == exit_not_converged;
    if (has_summary && !nlohmann::json::accept(content_of(path_of(i, "summary.json")))) return std::nullopt;
    return status;
  }

  std::string folder_of(std::size_t i) const { return order_.folder + "/" + cases_[i].name; }
  std::string path_of(std::size_t i, const char* name) const { return folder_of(i) + "/" + name; }

  void start(std::size_t i) {
    if (const std::optional<int> status = status_of_earlier(i)) {
      results_[i].was_there = true;
      take(i, *status);
      return;
    }
    std::error_code ignored;
    std::filesystem::remove(path_of(i, mark_name), ignored);
    remove_left_part(path_of(i, mark_name), mark_start);
    std::vector<std::string> words = {order_.program, order_.command, order_.scene_file, "-q", "-o", folder_of(i)};
    for (const std::string& assignment : cases_[i].overrides) words.insert(words.end(), {"--set", assignment});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    NamelessFile errors = nameless_file();
    posix_spawn_file_actions_adddup2(&files, fileno(errors.get()), STDERR_FILENO);
    pid_t process = 0;
    const int failed = posix_spawn(&process, order_.program.c_str(), &files, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0) throw WriteError(order_.program, fmt::format("cannot be started: {}", std::generic_category().message(failed)));
    running_.emplace(process, Running{i, std::move(errors)});
  }

  void check_all() {
    std::set<std::string> names;
    // All of them first: a wrong value among the last must not be found after an hour.
    for (const Case& one : cases_) {
      order_.interruption();
      if (!names.insert(one.name).second) throw InputError({one.name, 0}, "", "two cases have the same values", "different values");
      const Scene scene = read_scene(order_.scene_file, one.overrides);
      check_scene(scene);
      require_our_mark(order_.folder + "/" + one.name + "/" + mark_name);
      marks_.push_back(fmt::format("{}{} {} {:016x}\n", mark_start, version, order_.command, check_sum(write_scene(scene))));
      // What an earlier one has left, which is not run again, may be anybody's by now.
      const std::string folder = order_.folder + "/" + one.name;
      if (!status_of_earlier(marks_.size() - 1) && is_there(folder)) OutputFolder(folder).require_ours({order_.scene_file});
    }
  }

  void run_all() {
    std::size_t next = 0;
    while (next < cases_.size() || !running_.empty()) {
      while (next < cases_.size() && running_.size() < static_cast<std::size_t>(order_.jobs)) start(next++);
      order_.interruption();
      if (!running_.empty()) wait_for_one();
    }
  }

  /// Who has stopped the command wants no case to go on; what they have left is begun anew another time.
  void stop_running() {
    for (const auto& [process, one] : running_) kill(process, SIGTERM);
    for (const auto& [process, one] : running_) {
      while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) continue;
    }
    running_.clear();
  }

  void wait_for_one() {
    int state = 0;
    pid_t process = 0;
    // A signal does not end a wait for processes, which goes on after it.
    while ((process = waitpid(-1, &state, WNOHANG)) == 0) {
      order_.interruption();
      std::this_thread::sleep_for(pause);
    }
    if (process < 0) throw WriteError(order_.program, "its cases cannot be waited for");
    const auto place = running_.find(process);
    if (place == running_.end()) return;
    const Running ended = std::move(place->second);
    const std::size_t i = ended.number;
    running_.erase(place);
    const int status = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
    if (status != exit_success) results_[i].message = last_line(text_of(ended.errors.get()));
    // What was broken off, or refused as input, is tried again another time.
    if (status == exit_success || status == exit_not_converged) write_files({{path_of(i, mark_name), marks_[i] + std::to_string(status) + "\n"}});
    take(i, status);
  }

  void take(std::size_t i, int status) {
    CaseResult& result = results_[i];
    result.status = status;
    if (status == exit_success || status == exit_not_converged) {
      result.summary = content_of(path_of(i, "summary.json"));
      const nlohmann::json summary = nlohmann::json::parse(result.summary, nullptr, false);
      if (!summary.is_object()) {
        result.summary.clear();
      } else if (status == exit_not_converged) {
        result.message = summary.value("reason", "");
      }
    }
    ++ended_;
    done_(i, result);
  }

  const CaseOrder& order_;
  const std::vector<Case>& cases_;
  const std::function<void(std::size_t, const CaseResult&)>& done_;
  std::vector<std::string> marks_;
  std::vector<CaseResult> results_;
  std::map<pid_t, Running> running_;
  std::size_t ended_ = 0;
};

}  // namespace

std::vector<CaseResult> run_cases(const CaseOrder& order, const std::vector<Case>& cases,
                                  const std::function<void(std::size_t, const CaseResult&)>& done) {
  return Runner(order, cases, done).run();
}

void CaseWarnings::add(const std::string& name, const std::string& summary) {
  if (summary.empty()) return;
  std::set<std::string> told;
  const nlohmann::json warnings = nlohmann::json::parse(summary).value("warnings", nlohmann::json::array());
  for (const nlohmann::json& entry : warnings) {
    const auto text = entry.get<std::string>();
    if (told.insert(pattern_of(text)).second) note(name, text);
  }
}

std::string CaseWarnings::pattern_of(const std::string& text) {
  std::string pattern;
  std::ranges::copy_if(text, std::back_inserter(pattern), [](unsigned char c) { return !std::isdigit(c) && c != '.'; });
  return pattern;
}

void CaseWarnings::note(const std::string& name, const std::string& text) {
  const std::string pattern = pattern_of(text);
  const auto place = std::ranges::find(kinds_, pattern, &Kind::pattern);
  if (place == kinds_.end()) {
    kinds_.push_back({pattern, fmt::format("{}: {}", name, text)});
  } else {
    ++place->others;
  }
}

std::vector<std::string> CaseWarnings::texts() const {
  std::vector<std::string> list;
  for (const Kind& kind : kinds_) {
    const std::string others =
        kind.others == 0 ? ""
                         : fmt::format(" (and the same of {} other case{}, each with its own numbers)", kind.others, kind.others == 1 ? "" : "s");
    list.push_back(kind.first + others);
  }
  return list;
}

void require_not_set(const std::vector<std::string>& overrides, const std::string& key, const std::string& option) {
  for (const std::string& assignment : overrides) {
    if (key_of_override(assignment) == key)
      throw InputError({"--set " + assignment, 0}, "", fmt::format("{} has values of its own in every case", key), option + " alone for this key");
  }
}

std::string this_program() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

std::string status_word(int status) {
  switch (status) {
    case exit_success:
      return "success";
    case exit_not_converged:
      return "not converged";
    case exit_bad_input:
      return "bad input";
    default:
      return "broken off";
  }
}

std::string folder_name(const std::vector<std::string>& overrides) {
  std::string name;
  for (const std::string& assignment : overrides) {
    if (!name.empty()) name += ',';
    for (const char c : assignment)
      name += std::isalnum(static_cast<unsigned char>(c)) || std::string_view("._-=[]+").find(c) != std::string_view::npos ? c : '_';
  }
  return name;
}

}  // namespace openclose
